"""The ./robocop commands that README, CONTRIBUTING and docs/ print run as printed, in a folder with their files.

One of each program with the same options: test_documentation.py has all of them, with their launch arguments, checked.
"""

import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from documentation import commands, inline_commands
from students import copy_of
from systems import System

from aro_robocop_goto_as.process.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = 300.0  # [s, wall] for one command on a busy machine
OVERVIEW = r"^stop +Ctrl-C|is ready, no goal yet"
SERVING = {"run": OVERVIEW, "sim": OVERVIEW, "web": "http://", "record": "recording to", "replay": OVERVIEW}
INTERRUPTED = {0, 130, -signal.SIGINT}
UNFINISHED = "grade my_lab"  # exit status 1: not all points
# Why a command, recognised by how it begins, is not run here.
EXCEPTIONS = {
    "axclient": "needs a display: test/gui/test_axclient.py",
    "bench": "takes minutes",
    "clean": "removes the set-up that the tests use: test_robocop_command.py",
    "doctor": "its exit status reports what this machine lacks: cli/test_doctor.py",
    "grade-class hand_ins --scheduler": "needs a scheduler: test/solutions/test_class.py",
    "image": "needs docker, podman or buildah: test_container.py",
    "shell python3 -m distributed": "runs until it is ended: test/solutions/test_class.py",
    "shell python3 test/solutions/measure.py": "takes hours",
    "shell rosrun aro_robocop_goto_as robocop_rviz.py": "needs a display: test/gui/test_rviz_starts.py",
    "teleop": "needs a keyboard: teleop_test.py",
    "test": "this suite",
}
pytestmark = [pytest.mark.slow, pytest.mark.timeout(600), pytest.mark.xdist_group("hosting")]


def documented():
    """The commands without ./robocop, except those that only name a command in a sentence."""
    fenced = [re.sub(r"^(\w+=\S+ )*\./robocop ?", r"\1", command) for command in commands("./robocop")]
    inline = [command[len("./robocop ") :] for command in inline_commands("./robocop") if command.count(" ") > 1]
    return sorted({command for command in [*fenced, *inline] if command})


def exception(command):
    """The key of EXCEPTIONS that says why a command is not run."""
    words = [word for word in command.split() if not re.match(r"[A-Z]\w*=", word)]
    return next((begin for begin in EXCEPTIONS if " ".join(words).startswith(begin)), None)


def environment(folder):
    """A home of its own, without a display."""
    left_out = ("DISPLAY", "TURTLEBOT3_MODEL")
    kept = {name: value for name, value in os.environ.items() if name not in left_out}
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    return {**kept, "HOME": str(folder), "XDG_CACHE_HOME": cache}


@pytest.fixture
def folder(tmp_path):
    """What the commands name: a solution, a class, a package, a workspace, maps and a recording."""
    (tmp_path / "robocop").symlink_to(ROOT / "robocop")
    solution = copy_of("as_taught", tmp_path).rename(tmp_path / "solution")
    shutil.copy(solution / "scripts" / "robocop_goto_as.py", solution)
    shutil.copytree(solution, tmp_path / "hand_ins" / "somebody")
    shutil.copy(ROOT / "config" / "grading.yaml", tmp_path / "my_plan.yaml")
    shutil.copytree(solution, tmp_path / "my_package")
    shutil.copytree(solution, tmp_path / "catkin_ws" / "src" / "my_package")
    launch = next((tmp_path / "my_package" / "launch").iterdir())
    shutil.copy(launch, launch.with_name("other.launch"))
    for name in ("my_map", "path/to/map"):
        image = tmp_path / f"{name}.pgm"
        image.parent.mkdir(parents=True, exist_ok=True)
        image.write_bytes(b"P5 40 40 255\n" + bytes([254]) * 1600)
        text = f"image: {image.name}\nresolution: 0.05\norigin: [-1.0, -1.0, 0.0]\nnegate: 0\n"
        image.with_suffix(".yaml").write_text(f"{text}occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return tmp_path


class Commands(System):
    """Runs ./robocop as printed, in its folder and on a master of its own."""

    def _type(self, command):
        name, words = f"output_{len(self.running)}", ("bash", "-c", f"exec env {command}")
        return self.start(name, *words, cwd=self.directory, stdin=subprocess.DEVNULL)

    def serve(self, command, ready):
        """Start a command that serves until Ctrl-C, and wait until its output matches `ready`; the process."""
        process = self._type(command)
        self.wait(lambda: re.search(ready, process.output, re.M), command, process)
        return process

    def run(self, command):
        """Run a command that ends by itself; its exit status and output."""
        process = self._type(command)
        return process.wait(DEADLINE), process.output


@pytest.fixture
def system(folder):
    with Commands(folder, environment(folder)) as commands:
        yield commands


def of_each_kind():
    """The first command of each program with the same options and settings of the environment."""
    kinds = {}
    for command in documented():
        words = [word.partition("=")[0] for word in command.split() if ":=" not in word]
        program = next(word for word in words if not word.isupper())
        kinds.setdefault((program, *words[1:] * (program == "shell"), *(w for w in words if w[:2] == "--")), command)
    return [command for command in kinds.values() if exception(command) is None]


@pytest.mark.parametrize("command", of_each_kind())
def test_printed_command_runs(command, system):
    name = next(word for word in command.split() if "=" not in word)
    printed = re.sub(r"^((?:\w+=\S+ )*)", r"\1./robocop ", command)
    if name in ("run", "web", "replay") and "web_port" not in command:
        printed += f" web_port:={free_port()}"  # that of the documentation may be in use
    if "my_lab" in command and name != "new":
        system.run("./robocop new my_lab")
    if "--robot" in command or "rosnode" in command or name in ("web", "record", "replay"):
        lab = system.serve("./robocop run robots:=3 web:=false", SERVING["run"])
    if name == "replay":
        recording = system.serve("./robocop record run.bag", SERVING["record"])
        assert system.run("./robocop goto 0.3 0 --robot robot_1")[0] == 0
        assert {recording.end(signal.SIGINT), lab.end(signal.SIGINT)} <= INTERRUPTED
    if name in SERVING:
        assert system.serve(printed, SERVING[name]).end(signal.SIGINT) in INTERRUPTED
    else:
        status, output = system.run(printed)
        assert status == (1 if command == UNFINISHED else 0), output
