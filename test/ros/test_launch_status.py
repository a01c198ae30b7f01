"""robocop_launch.py, which is roslaunch but for its exit status: that tells how the simulator ended."""

import os
import signal
import subprocess
import time

import pytest
from test_rostests import processes_with

from aro_robocop_goto_as.loopback import free_port

DEADLINE = 60.0  # [s, wall]
READY = "robot at x"  # what the simulator says once it runs


class Launch:
    """The simulator alone on a master of its own; its output and the processes it starts."""

    def __init__(self, folder, *arguments):
        self.setting = b"ROS_HOME=" + os.fsencode(folder)
        self.output = folder / "output"
        environment = {**os.environ, "ROS_HOSTNAME": "localhost", "ROS_HOME": str(folder), "PYTHONUNBUFFERED": "1",
                       "ROS_LOG_DIR": str(folder / "log")}
        environment.pop("ROS_IP", None)
        command = ["rosrun", "aro_robocop_goto_as", "robocop_launch.py", "-p", str(free_port()), "aro_robocop_goto_as",
                   "robocop_sim.launch", "drive:=kinematic", *arguments]
        with open(self.output, "wb") as stream:
            self.process = subprocess.Popen(command, env=environment, stdout=stream, stderr=subprocess.STDOUT)

    def simulator(self):
        """Its process id once it has begun to simulate."""
        end = time.monotonic() + DEADLINE
        while READY not in self.output.read_text():
            assert self.process.poll() is None and time.monotonic() < end, self.output.read_text()
            time.sleep(0.01)
        for process in processes_with(self.setting):
            with open(f"/proc/{process}/cmdline") as stream:
                if "robocop_sim.py" in stream.read():
                    return process
        raise AssertionError("no simulator")

    def ends(self):
        """Its exit status; by then nothing that it started may be there."""
        status = self.process.wait(DEADLINE)
        assert processes_with(self.setting) == []
        return status


@pytest.fixture
def launch(tmp_path):
    started = []

    def start(*arguments):
        started.append(Launch(tmp_path, *arguments))
        return started[-1]

    yield start
    for it in started:
        for process in processes_with(it.setting):
            os.kill(process, signal.SIGKILL)
        it.process.wait()


def test_simulator_that_refuses_what_it_is_given_makes_the_launch_fail(launch):
    launched = launch("world:=no_such")
    assert launched.ends() == 1
    assert "there is no world 'no_such'" in launched.output.read_text()


def test_simulator_that_is_killed_makes_the_launch_fail(launch):
    launched = launch("world:=empty")
    os.kill(launched.simulator(), signal.SIGKILL)
    assert launched.ends() == 1


def test_simulator_that_ends_as_asked_is_no_failure(launch):
    launched = launch("world:=empty")
    os.kill(launched.simulator(), signal.SIGINT)
    assert launched.ends() == 0


def test_launch_that_is_interrupted_ends_all_and_is_no_failure(launch):
    launched = launch("world:=empty")
    launched.simulator()
    launched.process.send_signal(signal.SIGINT)
    assert launched.ends() == 0
    assert "Traceback" not in launched.output.read_text()
