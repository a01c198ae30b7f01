"""Whatever goes wrong while a file is read becomes its reader's error; numbers are read strictly."""

import pytest
import yaml
from lxml import etree

from aro_robocop_goto_as.errors import PlaceError, WorldError
from aro_robocop_goto_as.reading import finite_numbers, reading


def _open_nothing() -> None:
    open("/nowhere")


def _recurse() -> None:
    _recurse()


@pytest.mark.parametrize(
    "fail, message",
    [
        (_open_nothing, "f: can't read the file: No such file or directory"),
        (_recurse, "f: nested too deeply; expected a map"),
        (lambda: b"\xff".decode(), "f: not UTF-8 text: invalid start byte"),
        (
            lambda: etree.fromstring("<a>\n</b>"),
            "f:2: not well-formed XML: Opening and ending tag mismatch: a line 1 and",
        ),
        (lambda: etree.fromstring(b"<a>\xff</a>"), "f:1: not well-formed XML: Input is not proper UTF-8"),
        (lambda: yaml.safe_load("a\n: ]"), "f:2: not YAML: "),
        (lambda: int("one\ntwo"), r"f: invalid literal for int() with base 10: 'one\ntwo'; expected a map"),
        (lambda: [][0], "f: list index out of range; expected a map"),
    ],
)
def test_any_failure_becomes_the_readers_error_on_one_line(fail: "object", message: str) -> None:
    with pytest.raises(WorldError) as caught, reading("f", WorldError, "a map"):
        fail()  # type: ignore[operator]
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


def test_an_error_that_a_reader_raises_itself_is_kept() -> None:
    with pytest.raises(PlaceError, match="^here$"), reading("f", WorldError, "a map"):
        raise PlaceError("here")


def test_numbers_are_finite_and_as_many_as_expected() -> None:
    assert finite_numbers(" 1 -2e-1\t+.5 3. ", 4) == (1.0, -0.2, 0.5, 3.0)
    for text in ("1 2", "nan", "inf", "1e999", "1_000", "infinity", "", "1,5", "0x10"):
        with pytest.raises(ValueError, match="^expected one finite number$"):
            finite_numbers(text, 1)
    for text in ("0 1", "1 -1"):
        with pytest.raises(ValueError, match="^expected 2 finite numbers greater than 0$"):
            finite_numbers(text, 2, positive=True)
