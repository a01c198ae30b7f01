"""Bash completion: what Tab makes of a line, in a real interactive bash on a pseudoterminal."""

import os
import pty
import select
import signal
import subprocess
import time

import pytest
from command import ROOT

DEADLINE = 60.0  # [s, wall]
READY = "ready to type"
TAB, TO_START_OF_LINE = "\t", "\x01"


class Terminal:
    """A pseudoterminal with a shell in it, whose prompt is READY."""

    def __init__(self, command, folder):
        self.master, slave = pty.openpty()
        environment = {**os.environ, "TERM": "dumb", "HOME": str(folder), "INPUTRC": "/dev/null", "COLUMNS": "500"}
        self.process = subprocess.Popen(
            command, stdin=slave, stdout=slave, stderr=slave, env=environment, cwd=folder, start_new_session=True
        )
        os.close(slave)
        self.output = ""

    def type(self, text):
        os.write(self.master, text.encode())

    def wait_for(self, text):
        """Read until this text has come; returns the output since the last call up to it."""
        end = time.monotonic() + DEADLINE
        while text not in self.output:
            assert time.monotonic() < end and self.process.poll() is None, self.output
            if select.select([self.master], [], [], 0.1)[0]:
                self.output += os.read(self.master, 65536).decode(errors="replace")
        before, _, self.output = self.output.partition(text)
        return before

    def completed(self, line):
        """The line that Tab makes of a line: printed by an echo that is put before it."""
        self.type(f"{line}{TAB}{TO_START_OF_LINE}echo 'LINE' \n")
        self.wait_for("\nLINE ")
        return self.wait_for("\r\n").strip()

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        os.close(self.master)


@pytest.fixture(scope="module")
def shell(tmp_path_factory):
    """A shell without bash-completion that has read `./robocop completion`, in a folder with one package."""
    folder = tmp_path_factory.mktemp("home")
    (folder / "my_package").mkdir()
    (folder / "my_maze.sdf").write_text("")
    terminal = Terminal(["bash", "--norc", "--noprofile", "-i"], folder)
    terminal.type(f"source <({ROOT}/robocop completion) && PS1= && echo {READY[:5]}''{READY[5:]}\n")
    terminal.wait_for(READY)
    yield terminal
    terminal.close()


@pytest.mark.parametrize(
    "line, completed",
    [
        ("got", "goto"),
        ("grade-c", "grade-class"),
        ("new my_lab --cl", "new my_lab --classroom"),
        ("run real", "run real_time_factor:="),
        ("run world:", "run world:="),
        ("run world:=maz", "run world:=maze_1"),
        ("run world:=my_m", "run world:=my_maze.sdf"),
        ("run gui:=false model:=turtle", "run gui:=false model:=turtlebot2"),
        ("run goto_c", "run goto_config:="),
        ("sim goto_c", "sim goto_c"),
        ("sim gazebo", "sim gazebo_services:="),
        ("sim --wi", "sim --with"),
        ("replay my_m", "replay my_maze.sdf"),
        ("replay my_maze.sdf ra", "replay my_maze.sdf rate:="),
        ("sim --with my_p", "sim --with my_package/"),
        ("grade my_p", "grade my_package/"),
        ("grade my_package --rep", "grade my_package --report"),
        ("grade-class --sched", "grade-class --scheduler"),
        ("setup --rep", "setup --rep"),
        ("setup axc", "setup axclient"),
        ("help tel", "help teleop"),
        ("goto 1 0 --world maz", "goto 1 0 --world maze_1"),
        ("goto 1 0 --world my_m", "goto 1 0 --world my_maze.sdf"),
        ("shell rostop", "shell rostopic"),
    ],
)
def test_tab_completes(shell, line, completed):
    assert shell.completed(f"./robocop {line}") == f"./robocop {completed}"


def test_rostopic_pub_is_completed_in_robocop_shell(tmp_path):
    (tmp_path / ".bashrc").write_text("# the user's own, without bash-completion\n")
    terminal = Terminal([str(ROOT / "robocop"), "shell"], tmp_path)
    try:
        terminal.wait_for("(robocop) ")
        assert terminal.completed("rostopic pub /x geometry_msgs/Poin") == "rostopic pub /x geometry_msgs/Point"
        assert terminal.completed("./robocop got") == "./robocop goto"
    finally:
        terminal.close()
