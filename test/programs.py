"""A program in a ROS environment of its own: its output, the processes it starts, and how it ends."""

import contextlib
import os
import signal
import subprocess

import waiting
from processes import processes_with


class Program:
    """Started with ROS_HOME in a folder, by which the processes that it starts are found."""

    deadline = waiting.DEADLINE  # [s, wall] for any one condition, and for its end
    poll = 0.01  # [s, wall]
    start = ("rosrun", "aro_robocop_goto_as")

    def __init__(self, folder, *command, **environment):
        self.environment = {
            **os.environ,
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(folder),
            "ROS_LOG_DIR": str(folder / "log"),
            "PYTHONUNBUFFERED": "1",
            **environment,
        }
        self.environment.pop("ROS_IP", None)
        self._setting = b"ROS_HOME=" + os.fsencode(folder)
        self._log = folder / "output"
        with open(self._log, "wb") as output:
            self.process = subprocess.Popen(
                [*self.start, *command],
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )

    @property
    def output(self):
        """What it has written so far."""
        return self._log.read_text(errors="replace")

    def processes(self, word=""):
        """Ids of its processes with this word on their command line."""
        return processes_with(self._setting, word.encode())

    def wait_until(self, condition, what):
        """The first true value of a condition, while the program runs."""

        def problem():
            return f"{what} (exit status {self.process.poll()}): {self.output}"

        return waiting.wait_for(
            condition, problem, self.deadline, self.poll, given_up=lambda: self.process.poll() is not None
        )

    def wait_for_process(self, word):
        """The id of a process with this word on its command line, once there is one."""
        return self.wait_until(lambda: self.processes(word), f"{word} runs")[0]

    def wait_for_exit(self):
        """Its exit status; by then none of its processes may be left."""
        status = self.process.wait(self.deadline)
        assert self.processes() == []
        return status

    def kill(self):
        """Kill what is left of it, also what it starts meanwhile."""
        self.process.kill()
        self.process.wait()
        while True:
            left = self.processes()
            if not left:
                return
            for process in left:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
