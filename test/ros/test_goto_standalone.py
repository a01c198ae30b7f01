"""`robocop goto` without a running ROS: it starts a system for that goal and leaves none of its processes behind."""

import signal
import socket

import pytest
import waiting
from systems import Program


@pytest.fixture
def goto(started, tmp_path):
    """The command, with no master at its ROS_MASTER_URI."""
    return lambda *arguments: started(Program(tmp_path, "robocop_goto.py", *arguments))


def test_goal_is_reached_in_a_system_started_for_it(goto):
    command = goto("0.15", "0", "--world", "empty")
    assert command.wait_for_exit() == 0, command.output
    assert "SUCCEEDED: REACHED: " in command.output


@pytest.mark.slow
def test_launch_arguments_choose_its_simulator(goto):
    command = goto("0.15", "0", "robots:=red 0 0", "--robot", "red", "world:=empty")
    assert command.wait_for_exit() == 0, command.output
    assert "in red/odom after" in command.output


@pytest.mark.parametrize(
    "word, message",
    [
        ("wrld:=empty", "there is no argument wrld; "),
        ("robot:=red", "did you mean --robot red?"),
        ("drive:=wheel", "drive: "),
        ("7", "expected NAME:=VALUE"),
    ],
)
def test_impossible_launch_arguments_are_refused_and_nothing_is_started(goto, word, message):
    command = goto("1", "0", word)
    assert command.wait_for_exit() == 2
    assert message in command.output and "starting" not in command.output


def test_a_robots_name_is_refused_where_no_system_runs(goto):
    command = goto("0.5", "0.2", "--robot", "red")
    assert command.wait_for_exit() == 1
    assert "--robot red: no ROS master answers" in command.output


ONCE, TWICE = [signal.SIGINT], [signal.SIGTERM, signal.SIGINT]


@pytest.mark.slow
@pytest.mark.parametrize("word, signals", [("robocop_launch.py", ONCE), ("robocop_sim.py", TWICE)])
def test_interrupted_while_the_system_starts_it_leaves_nothing_behind(goto, word, signals):
    command = goto("5", "0", "--world", "empty")
    command.wait_for_process(word)
    for number in signals:
        command.process.send_signal(number)
    assert command.wait_for_exit() == 1
    assert "Traceback" not in command.output


def test_interrupted_while_the_master_does_not_answer_it_starts_nothing(goto):
    command = goto("1", "0")
    with socket.create_server(("127.0.0.1", command.port)) as silent:
        silent.settimeout(command.deadline)
        connection, _ = silent.accept()
        assert connection.recv(1)
        command.process.send_signal(signal.SIGINT)
        assert command.wait_for_exit() == 1
    assert command.output == "robocop goto: interrupted\n"


@pytest.mark.slow
def test_the_system_ends_also_if_the_command_is_killed(goto):
    command = goto("5", "0", "--world", "empty")
    command.wait_until(lambda: "driving" in command.output, "driving")
    command.process.kill()
    waiting.wait_for(lambda: not command.processes(), lambda: f"the end of {command.processes()}: {command.output}")


@pytest.mark.slow
def test_terminated_on_its_way_it_reports_how_the_goal_ended(goto):
    command = goto("5", "0", "--world", "empty")
    command.wait_until(lambda: "driving" in command.output, "driving")
    command.process.send_signal(signal.SIGTERM)
    assert command.wait_for_exit() == 1
    assert "\nPREEMPTED: goal " in command.output


def test_unknown_world_is_a_wrong_argument_and_nothing_is_started(goto):
    command = goto("1", "0", "--world", "stag_1")
    assert command.wait_for_exit() == 2
    assert "there is no world 'stag_1'" in command.output
    assert "did you mean stage_1?" in command.output and "starting" not in command.output


@pytest.mark.slow
def test_world_that_cannot_be_read_is_reported_with_the_log_to_read(goto, tmp_path):
    world = tmp_path / "half.sdf"
    world.write_text("<sdf version='1.6'><world")
    command = goto("1", "0", "--world", str(world))
    assert command.wait_for_exit() == 1
    assert f"{world}:1:" in command.output
    assert "robocop_goto.log" in command.output
