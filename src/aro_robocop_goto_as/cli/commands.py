"""./robocop COMMAND: checks the arguments, installs what is missing, and becomes the program that does the work.

The shell script `robocop` starts it when nothing may be installed yet, so it uses Python's standard library only.
"""

import glob
import os
import shlex
import subprocess
import sys
from typing import Callable, Dict, List, NoReturn, Sequence

from ..errors import RobocopError
from ..names import robocop
from ..suggestions import did_you_mean
from . import container_image, doctor, program, system_commands
from .help_texts import described, shown
from .program import ROOT, refuse, say

UNKNOWN_COMMAND = 2  # exit status
NOT_GRADED = 4  # exit status of the graders
# Of Debian's rosbash, which needs no bash-completion; of ROS in /opt/ros, setup.bash loads them.
COMPLETIONS = "/usr/share/bash-completion/completions/rosbash"
SHELL_SETTINGS = """\
[ ! -r ~/.bashrc ] || . ~/.bashrc
PATH={venv}/bin:/usr/bin:/bin:$PATH  # ~/.bashrc may have put another Python first
. "$ROBOCOP_WS/setup.bash"
[ ! -r {completions} ] || . {completions}
robocop() {{ {script} "$@"; }}  # in whatever folder
PS1="(robocop) $PS1"
"""


def grader(command: str, *parts: str) -> Callable[[List[str]], None]:
    """A command that grades what its arguments name, by a script of the package; the script needs these parts."""

    def grade(arguments: List[str]) -> None:
        expect_something(command, arguments)
        program.need("hosting", "grade", *parts)
        program.start_script(f"robocop_{command.replace('-', '_')}.py", *arguments)

    return grade


def expect_something(command: str, arguments: List[str]) -> None:
    """End with an error, before anything is installed, if no argument is a file, or a folder with something in it."""
    found = any(os.path.isfile(word) or glob.glob(f"{glob.escape(word)}/*") for word in arguments)
    if not (found or program.is_dry_run() or {"-h", "--help"} & set(arguments)):
        word = next((word for word in arguments if not word.startswith("-")), "nothing")
        word += " (the folder is empty)" if os.path.isdir(word) else ""
        say(f"{command}: expected a file or folder with something to grade, got: {word}")
        sys.exit(NOT_GRADED)


def shell(arguments: List[str]) -> None:
    """Run a command in the workspace, or open a shell in it."""
    program.need()
    if arguments:
        program.start(*arguments)
    settings, script = program.state() / "bashrc", shlex.quote(program.SCRIPT)
    if not program.is_dry_run():
        text = SHELL_SETTINGS.format(venv=program.state() / "venv", completions=COMPLETIONS, script=script)
        settings.write_text(text, encoding="utf-8")
    program.start("bash", "--rcfile", str(settings))


def setup(parts: List[str]) -> None:
    """Only install and build."""
    known = sorted(path.stem for path in (ROOT / "install" / "deb-packages").glob("*.txt"))
    for part in parts:
        if part not in known:
            refuse(f"setup: there is no part '{part}'; there are: {' '.join(known)}{did_you_mean(part, known)}")
    program.need(*parts)
    if program.is_dry_run():
        return
    if "grade" in parts:  # what the first grading would build: a container would repeat it at each start
        prebuild = program.module("robocop_grading.submission")
        subprocess.run(prebuild, env=program.workspace_environment(), check=True)
    say(f"ready in {program.state()}; {robocop()} run starts the lab")


def test(arguments: List[str]) -> None:
    """Run the tests with pytest."""
    every = "--all" in arguments
    program.need("rviz", "hosting", "grade", "class", "web", "test")
    os.chdir(ROOT)
    for tool in ("HYPOTHESIS_STORAGE_DIRECTORY", "MYPY_CACHE_DIR", "RUFF_CACHE_DIR"):
        os.environ[tool] = str(program.state() / tool.partition("_")[0].lower())
    # Run one test more at a time than there are processors, as tests often wait. With --all, pyproject.toml sets two,
    # because its attacks and load tests are designed for one test beside them.
    workers = [] if every else ["-n", str(len(os.sched_getaffinity(0)) + 1)]
    program.start(*program.module("pytest", "-o", f"cache_dir={program.state()}/pytest", *workers, *arguments))


def bench(arguments: List[str]) -> None:
    """Measure the simulator."""
    program.need()
    python, *_ = program.module("")
    program.start(python, str(ROOT / "test" / "robocop_bench.py"), *arguments)


def show_help(commands: List[str]) -> None:
    """What the help text says about commands."""
    for command in commands:
        print(shown(command) or refuse_unknown(command), end="")


def refuse_unknown(command: str) -> NoReturn:
    """End with an error for a command that does not exist."""
    ends = command in ("stop", "kill", "quit", "exit")
    hint = "; Ctrl-C in its terminal ends what runs there" if ends else did_you_mean(command, described())
    say(f"unknown command '{command}' ({robocop()} help lists them){hint}")
    sys.exit(UNKNOWN_COMMAND)


def clean(arguments: List[str]) -> None:
    """End with an error about arguments; without arguments, the shell script itself removes what was built."""
    refuse(f"clean: expected no arguments, got {' '.join(arguments)}")


def to_script(name: str, *parts: str) -> Callable[[List[str]], None]:
    """A command that passes its arguments on to a script of the package; the script needs these parts."""

    def start_script(arguments: List[str]) -> None:
        program.need(*parts)
        program.start_script(name, *arguments)

    return start_script


# What the words of help.txt do; without arguments, the shell script does the last two itself.
COMMANDS: Dict[str, Callable[[List[str]], None]] = {
    "run": system_commands.run,
    "sim": system_commands.sim,
    "goto": system_commands.goto,
    "record": system_commands.record,
    "replay": system_commands.replay,
    "teleop": to_script("robocop_teleop.py"),
    "axclient": system_commands.axclient,
    "web": to_script("robocop_web.py", "web"),
    "new": to_script("robocop_new.py"),
    "grade": grader("grade"),
    "grade-class": grader("grade-class", "class"),
    "test": test,
    "bench": bench,
    "shell": shell,
    "setup": setup,
    "image": container_image.build,
    "doctor": lambda _: sys.exit(doctor.report(program.SCRIPT, str(ROOT), str(program.state()))),
    "version": lambda _: print(program.version()),
    "--version": lambda _: print(program.version()),
    "clean": clean,
    "help": show_help,
}
OWN_HELP = ("goto", "teleop", "new", "grade", "grade-class", "bench", "test", "shell")  # they read --help themselves


def main(words: Sequence[str]) -> None:
    """Do what a command and its arguments say."""
    command, *arguments = words
    if command not in COMMANDS:
        refuse_unknown(command)
    if command not in OWN_HELP and {"-h", "--help"} & set(arguments):
        print(shown(command), end="")
        return
    try:
        COMMANDS[command](arguments)
    except RobocopError as error:
        refuse(str(error))
