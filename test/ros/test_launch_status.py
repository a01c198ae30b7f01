"""robocop_launch.py: its exit status reports how the simulator ended, and an interrupt ends all of its processes."""

import os
import signal
import sys
from pathlib import Path

import pytest
from systems import Program

ROOT = Path(__file__).resolve().parents[2]


class Launch(Program):
    """The simulator alone on a master of its own."""

    command = (sys.executable, str(ROOT / "launch" / "robocop_launch.py"))
    poll = 0.001  # [s, wall] because the tests interrupt it at certain moments of its start

    def __init__(self, folder, *arguments, file="robocop_sim.launch"):
        options = [argument for argument in arguments if argument.startswith("--")]
        rest = [argument for argument in arguments if argument not in options]
        super().__init__(folder, *options, "aro_robocop_goto_as", file, "drive:=kinematic", *rest)


@pytest.fixture
def launch(started, tmp_path):
    return lambda *arguments, **options: started(Launch(tmp_path, *arguments, **options))


def test_quiet_launch_shows_the_world_the_robot_and_what_to_do_on_one_screen(launch):
    launched = launch("--quiet", "world:=empty", "model:=waffle")
    launched.wait_for_process("robocop_sim.py")
    launched.wait_until(lambda: "all messages" in launched.output, "the overview is shown")
    shown = launched.output
    assert "world         empty\nrobot         waffle\n" in shown and "Ctrl-C" in shown
    assert "PARAMETERS" not in shown and len(shown.splitlines()) < 24
    (folder,) = [line.split()[2] for line in shown.splitlines() if line.startswith("all messages")]
    logs = Path(folder)
    launched.wait_until(lambda: "robot at x" in "".join(log.read_text() for log in logs.glob("*.log")), "it is logged")
    launched.process.send_signal(signal.SIGINT)  # which is no failure, and ends all processes
    assert launched.wait_for_exit() == 0 and "Traceback" not in launched.output


@pytest.mark.slow
def test_quiet_launch_tells_of_a_node_that_has_ended_without_an_error_and_no_node_makes_a_link(launch, tmp_path):
    (tmp_path / "ros" / "log" / "latest").mkdir(parents=True)  # in whose place no link can be made
    arguments = ("sim:=false", "rviz:=false", "bridge:=false")
    launched = launch("--quiet", *arguments, file="robocop_goto_as.launch")
    launched.wait_until(lambda: launched.subscriber("/odom", "/aro_robocop_goto_as_node"), "the server")
    os.kill(launched.wait_for_process("robocop_goto_as.py"), signal.SIGINT)
    launched.wait_until(lambda: "process has finished cleanly" in launched.output, "roslaunch names it")
    assert launched.output.count("cannot create a symlink to latest log directory") == 2  # roslaunch, then its master


def test_launch_fails_and_shows_why_when_the_simulator_refuses_its_world(launch, tmp_path):
    (tmp_path / "empty.sdf").touch()
    launched = launch("--quiet", f"world:={tmp_path}/empty.sdf")
    assert launched.wait_for_exit() == 1
    assert "empty.sdf:1: not XML" in launched.output
    assert "Ctrl-C" not in launched.output  # nothing about how to use what does not run


def test_launch_explains_an_impossible_argument_without_a_traceback(launch):
    launched = launch("model:=../../etc/passwd")
    assert launched.wait_for_exit() == 1
    assert "there is no model '../../etc/passwd'; known are: burger, " in launched.output
    assert "Traceback" not in launched.output


def test_launch_names_a_parameter_that_has_another_type_or_no_value(launch, tmp_path):
    launched = launch("moving:=maybe")
    assert launched.wait_for_exit() == 1
    assert "maybe is not a 'bool' type" in launched.output and 'name="moving"' in launched.output
    assert "Node xml" not in launched.output
    (tmp_path / "mine.yaml").write_text("odom_rate: 20\ncontrol_rate:\n")
    launched = launch(f"config:={tmp_path}/mine.yaml")
    assert launched.wait_for_exit() == 1
    assert "[FATAL] /robocop_sim/control_rate: cannot marshal None" in launched.output
    assert "Traceback" not in launched.output


@pytest.mark.slow
@pytest.mark.parametrize("number, status", [(signal.SIGKILL, 1), (signal.SIGINT, 0)])
def test_launch_fails_when_the_simulator_is_killed_but_not_when_it_is_interrupted(launch, number, status):
    launched = launch("world:=empty")
    launched.wait_until(lambda: "robot at x" in launched.output, "the simulator runs")
    os.kill(launched.wait_for_process("robocop_sim.py"), number)
    assert launched.wait_for_exit() == status


@pytest.mark.slow
@pytest.mark.parametrize("program", ["rosmaster", "robocop_sim.py"])
def test_launch_interrupted_while_it_starts_a_process_leaves_none_behind(launch, program):
    launched = launch("world:=empty")
    launched.wait_for_process(program)
    for number in (signal.SIGTERM, signal.SIGINT):
        launched.process.send_signal(number)
    assert launched.wait_for_exit() == 0  # a node whose interpreter is just starting may have printed a traceback
