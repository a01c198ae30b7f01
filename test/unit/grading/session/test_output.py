"""All that a node prints becomes lines, in order, however it is written; of a flood only the beginning is kept."""

import os

import pytest

from robocop_grading.session.output import MAX_LINE, MAX_READ, Output


@pytest.fixture
def printed():
    """The end that a node writes to, what reads it, and the lines so far."""
    theirs, mine = os.pipe(), []
    output = Output(os.fdopen(theirs[0], "rb", buffering=0), mine.append)
    yield theirs[1], output, mine
    output.close()


def test_a_line_is_passed_on_when_it_is_complete(printed):
    writer, output, lines = printed
    os.write(writer, b"one\ntw")
    output.pass_on()
    assert lines == ["one"]
    os.write(writer, b"o\n\nthree")
    output.read()
    assert lines == ["one"]  # not before it is asked for
    output.pass_on()
    assert lines == ["one", "two"]
    os.close(writer)
    output.pass_on()  # reads the end
    assert lines == ["one", "two", "three"]
    assert not output.is_open


def test_an_unfinished_line_is_passed_on_when_the_node_is_ended(printed):
    writer, output, lines = printed
    os.write(writer, b"half a line")
    output.close()
    output.close()
    assert lines == ["half a line"]
    os.close(writer)


def test_a_long_line_is_several_and_bytes_that_are_no_text_are_replaced(printed):
    writer, output, lines = printed
    os.write(writer, b"x" * (MAX_LINE + 1) + b"\xff\n")
    os.close(writer)
    output.pass_on()
    assert lines == ["x" * MAX_LINE, "x\ufffd"]


def test_a_node_that_prints_a_lot_need_not_wait_for_the_grader(printed):
    writer, output, _lines = printed
    os.set_blocking(writer, False)
    assert os.write(writer, b"x" * 1_000_000) == 1_000_000
    output.read()
    os.close(writer)


def test_a_text_that_overwrites_a_line_is_a_line_without_its_end(printed):
    writer, output, lines = printed
    for text in (b"\rstate: ACTIVE", b"\rstate: SUCCEEDED", b"\r\nover\r", b"\nend"):
        os.write(writer, text)
        output.pass_on()
    assert lines == ["state: ACTIVE", "state: SUCCEEDED", "over"]
    os.close(writer)


def test_of_a_flood_the_beginning_is_kept_and_the_rest_is_read(printed):
    writer, output, lines = printed
    for _ in range(2):
        for _ in range(2 * MAX_READ // 1000):
            os.write(writer, b"x" * 999 + b"\n")  # blocks for ever if nobody reads
            output.read()
        output.pass_on()
    assert len(lines) == 2 * MAX_READ // 1000
    os.close(writer)
