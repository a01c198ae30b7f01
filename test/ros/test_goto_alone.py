"""`robocop goto` where no ROS runs: it starts a system for that goal, and leaves nothing of it behind."""

import os
import signal
import socket
import subprocess
import time

import pytest
from processes import processes_with

from aro_robocop_goto_as.loopback import free_port

DEADLINE = 120.0  # [s, wall]


class Goto:
    """The command on its own, with no master where it looks for one; its output and the processes it starts."""

    def __init__(self, folder, *arguments):
        self.port = free_port()
        self.setting = b"ROS_HOME=" + os.fsencode(folder)
        self.output = folder / "output"
        environment = {**os.environ, "ROS_HOSTNAME": "localhost", "ROS_HOME": str(folder), "PYTHONUNBUFFERED": "1",
                       "ROS_LOG_DIR": str(folder / "log"), "ROS_MASTER_URI": f"http://localhost:{self.port}"}
        environment.pop("ROS_IP", None)
        with open(self.output, "wb") as stream:
            self.process = subprocess.Popen(["rosrun", "aro_robocop_goto_as", "robocop_goto.py", *arguments],
                                            env=environment, stdout=stream, stderr=subprocess.STDOUT)

    def wait_until(self, condition, what):
        end = time.monotonic() + DEADLINE
        while not condition():
            assert self.process.poll() is None and time.monotonic() < end, f"{what}: {self.output.read_text()}"
            time.sleep(0.01)

    def runs(self, program):
        """Whether one of its processes has this word on its command line."""
        return bool(processes_with(self.setting, program.encode()))

    def ends(self):
        """Its exit status; by then nothing that it started may be there."""
        status = self.process.wait(DEADLINE)
        assert processes_with(self.setting) == []
        return status


@pytest.fixture
def goto(tmp_path):
    started = []

    def start(*arguments):
        started.append(Goto(tmp_path, *arguments))
        return started[-1]

    yield start
    for it in started:
        for process in processes_with(it.setting):
            os.kill(process, signal.SIGKILL)


def test_goal_is_reached_in_a_system_of_its_own(goto):
    command = goto("0.5", "0.2", "--world", "empty")
    assert command.ends() == 0, command.output.read_text()
    assert "SUCCEEDED: REACHED: " in command.output.read_text()


@pytest.mark.parametrize("word", ["robocop_launch.py", "rosmaster", "robocop_sim.py"])
@pytest.mark.parametrize("numbers", [[signal.SIGINT], [signal.SIGTERM, signal.SIGINT]])
def test_interrupted_while_the_system_starts_it_leaves_nothing_behind(goto, word, numbers):
    command = goto("5", "0", "--world", "empty")
    command.wait_until(lambda: command.runs(word), f"{word} runs")
    for number in numbers:
        command.process.send_signal(number)
    assert command.ends() == 1
    assert "Traceback" not in command.output.read_text()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_while_it_asks_a_master_that_does_not_answer_it_starts_nothing(goto, number):
    command = goto("1", "0")
    with socket.create_server(("127.0.0.1", command.port)) as mute:
        mute.settimeout(DEADLINE)
        asked, _ = mute.accept()
        assert asked.recv(1)
        command.process.send_signal(number)
        assert command.ends() == 1
    assert command.output.read_text() == "robocop goto: interrupted\n"


def test_terminated_on_its_way_it_tells_how_the_goal_ended(goto):
    command = goto("5", "0", "--world", "empty")
    command.wait_until(lambda: "driving" in command.output.read_text(), "driving")
    command.process.send_signal(signal.SIGTERM)
    assert command.ends() == 1
    assert "PREEMPTED: PREEMPTED: " in command.output.read_text()


def test_unknown_world_is_told_with_the_log_to_read(goto):
    command = goto("1", "0", "--world", "no_such")
    assert command.ends() == 1
    assert "there is no world 'no_such'" in command.output.read_text()
    assert "robocop_goto.log" in command.output.read_text()
