"""The package's programs as ROS starts them: without ./robocop, a display or a master."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from command import robocop
from systems import Program, is_running
from waiting import DEADLINE, wait_for

from robocop_hosting.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
NODES = ("robocop_goto_as.py", "robocop_rviz.py", "robocop_rviz_goto_ac.py", "robocop_sim.py", "robocop_web.py")


@pytest.mark.parametrize("name", sorted(path.name for path in (ROOT / "scripts").glob("*.py")))
def test_each_program_answers_help_without_a_master(name):
    environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    environment.pop("ROBOCOP_STATE")  # as without ./robocop
    done = subprocess.run(
        [ROOT / "scripts" / name, "--help"], env=environment, capture_output=True, text=True, timeout=DEADLINE
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert f"usage: rosrun aro_robocop_goto_as {name}" in done.stdout
    assert name not in NODES or len(done.stdout.splitlines()) == 3
    command = name[len("robocop_") : -len(".py")].replace("_", "-")
    if name not in NODES and command != "sim-with":
        options = set(re.findall(r"--[a-z-]+", done.stdout)) - {"--help"}
        described = set(re.findall(r"--[a-z-]+", robocop(command, "--help").stdout))
        assert options == described, "./robocop help tells the same, before anything is installed"


class Roslaunch(Program):
    """roslaunch without a display."""

    command = ("roslaunch", "aro_robocop_goto_as")


@pytest.fixture
def roslaunch(started, tmp_path):
    return lambda *arguments: started(Roslaunch(tmp_path, *arguments, DISPLAY=""))


@pytest.mark.slow
def test_without_a_display_roslaunch_leaves_rviz_out_with_one_warning_and_goes_on(roslaunch):
    launched = roslaunch("robocop_goto_as.launch", "drive:=kinematic")
    launched.wait_until(lambda: "RViz is not started" in launched.output, "the warning")
    goto = [sys.executable, ROOT / "scripts" / "robocop_goto.py", "--frame", "odom", "0.2", "0"]
    done = subprocess.run(goto, env=launched.environment, capture_output=True, text=True, timeout=DEADLINE)
    assert done.returncode == 0, done.stdout + done.stderr
    assert launched.output.count("no usable display") == 1 and "Traceback" not in launched.output
    launched.process.interrupt()
    assert launched.wait_for_exit() == 0


@pytest.mark.slow
def test_a_second_launch_ends_and_the_first_goes_on_until_its_master_ends(roslaunch):
    arguments = ("robocop_goto_as.launch", "rviz:=false", "drive:=kinematic")
    launched = roslaunch(*arguments)
    launched.wait_until(lambda: "is ready, no goal yet" in launched.output, "the system")
    assert launched.output.count("/robocop_goto_as is ready for goals") == 1
    names = ("robocop_sim.py", "robocop_goto_as.py", "robocop_rviz_goto_ac.py")
    first = [launched.processes(name) for name in names]
    second = launched.start("second", *Roslaunch.command, *arguments)
    second.wait_for_exit()
    assert "robocop_sim: a simulator is already running as /robocop_sim on" in second.output
    assert [launched.processes(name) for name in names] == first
    frames = "/robocop_state_publisher"  # ROS's own node has ended, and started again
    launched.wait_until(lambda: is_running(launched.uri, frames), "the state publisher")
    ((simulator,), _, _) = first

    os.kill(launched.process.pid, signal.SIGSTOP)  # roslaunch itself would end the simulator, too
    try:
        os.kill(launched.processes("rosmaster")[0], signal.SIGKILL)
        wait_for(lambda: ended(simulator), lambda: launched.output)
    finally:
        os.kill(launched.process.pid, signal.SIGCONT)
    assert "has ended, and so does /robocop_sim" in launched.output


def test_a_program_that_waits_for_a_master_says_so_and_is_ended_by_an_interrupt(tmp_path):
    with Program(tmp_path, "robocop_goto_as.py") as program:
        program.wait_until(lambda: "waiting for a ROS master" in program.output, "the message")
        program.process.send_signal(signal.SIGINT)
        assert program.wait_for_exit() in (128 + signal.SIGINT, -signal.SIGINT)
        assert "Traceback" not in program.output


def ended(pid):
    """Whether a process is gone, or waits for its stopped parent to notice."""
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z"
