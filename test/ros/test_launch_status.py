"""robocop_launch.py, which is roslaunch but for how it ends: with a status that tells, at any moment, and with all."""

import contextlib
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest
from processes import processes_with

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
        self.port = free_port()
        command = ["rosrun", "aro_robocop_goto_as", "robocop_launch.py", "-p", str(self.port), "aro_robocop_goto_as",
                   "robocop_sim.launch", "drive:=kinematic", *arguments]
        with open(self.output, "wb") as stream:
            self.process = subprocess.Popen(command, env=environment, stdout=stream, stderr=subprocess.STDOUT)

    def simulator(self):
        """Its process id once it has begun to simulate."""
        self.wait_until(lambda: READY in self.output.read_text())
        return self.runs("robocop_sim.py")

    def runs(self, program):
        """The id, once there is one, of a process of the launch with this word on its command line."""
        found = []
        self.wait_until(lambda: found.extend(processes_with(self.setting, program.encode())) or found)
        return found[0]

    def wait_until(self, condition):
        """Wait for a condition, as long as the launch lives."""
        end = time.monotonic() + DEADLINE
        while not condition():
            assert self.process.poll() is None and time.monotonic() < end, self.output.read_text()
            time.sleep(0.001)

    def has_handlers(self, process):
        """Whether a process has come so far that it handles SIGTERM itself."""
        (line,) = [line for line in Path(f"/proc/{process}/status").read_text().splitlines() if "SigCgt" in line]
        return bool(int(line.split()[1], 16) >> signal.SIGTERM - 1 & 1)

    def asks_the_master(self, process):
        """Whether a process has sent the master what that one has not read yet."""
        sockets = set()
        for entry in Path(f"/proc/{process}/fd").iterdir():
            with contextlib.suppress(FileNotFoundError):  # closed meanwhile
                sockets.add(os.readlink(entry))
        rows = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
        master = f"0100007F:{self.port:04X}"
        mine = {row[1] for row in rows if row[2] == master and f"socket:[{row[9]}]" in sockets}
        return any(row[1] == master and row[2] in mine and int(row[4].split(":")[1], 16) for row in rows)

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


def test_simulator_that_is_told_to_end_while_it_waits_for_the_master_ends_when_that_answers(launch):
    launched = launch("world:=empty")
    simulator, (master,) = launched.runs("robocop_sim.py"), processes_with(launched.setting, b"/rosmaster")
    launched.wait_until(lambda: launched.has_handlers(simulator))
    os.kill(master, signal.SIGSTOP)
    try:
        launched.wait_until(lambda: launched.asks_the_master(simulator))
        os.kill(simulator, signal.SIGINT)
    finally:
        os.kill(master, signal.SIGCONT)
    assert launched.ends() == 0


@pytest.mark.parametrize("numbers", [[signal.SIGINT], [signal.SIGTERM, signal.SIGINT]])
@pytest.mark.parametrize("program", ["/rosmaster", "/rosout", "robocop_sim.py", "/robot_state_publisher"])
def test_launch_that_is_interrupted_while_it_starts_a_process_loses_none(launch, program, numbers):
    launched = launch("world:=empty")
    launched.runs(program)
    for number in numbers:
        launched.process.send_signal(number)
    assert launched.ends() == 0
