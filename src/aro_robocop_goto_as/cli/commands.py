"""./robocop COMMAND: checks the arguments of a command, before anything is installed.

The shell script `robocop` starts it with the system's Python, so it uses the standard library, and ROS if it is there.
What the script has to do is printed as a line of shell words: PART... -- PROGRAM ARGUMENT..., that is the lists in
install/ of what the command needs, and what to start.
"""

import glob
import os
import shlex
import sys
import textwrap
import time
from pathlib import Path
from typing import Callable, Dict, List, NoReturn, Sequence, Tuple

from .. import x_display
from ..errors import RobocopError
from ..launch_arguments import TRUE, LaunchArguments, described, with_absolute_path
from ..names import ACTION, ACTION_TYPE, PACKAGE, ROOT, SIMULATOR, absolute, robocop
from ..own_path import expect_own
from ..suggestions import did_you_mean
from . import doctor

HELP = Path(__file__).with_name("help.txt")
# The launch files whose arguments a command takes.
RUN, SIM, REPLAY = (ROOT / "launch" / f"{name}.launch" for name in ("robocop_goto_as", "robocop_sim", "replay"))
LAUNCH_FILES = {"run": (RUN, SIM), "sim": (SIM,), "replay": (REPLAY,)}  # with the one that describes what it passes on
NOT_GRADED = 4  # exit status of the graders
# What rosbag leaves out: what is large, as a camera's images that are not compressed, and rosout for the second time.
NOT_RECORDED = "/(.*/)?(image_raw|points|rosout_agg)"
INDENT = " " * 29  # of the texts in help.txt
Plan = Tuple[List[str], List[str]]  # parts, program with its arguments


def say(text: str) -> None:
    """Print a message to standard error."""
    print(f"robocop: {text}", file=sys.stderr, flush=True)


def refuse(text: str) -> NoReturn:
    """End with a message and exit status 1."""
    raise SystemExit(f"robocop: {text}")


def is_dry_run() -> bool:
    """Return whether nothing may be installed, built or started."""
    return bool(os.environ.get("ROBOCOP_DRY_RUN"))


def script(name: str) -> str:
    """The path of one of the package's scripts in the workspace."""
    return f"{os.environ['ROBOCOP_WS']}/lib/{PACKAGE}/{name}"


def require_system(starts_simulator: bool = True) -> None:
    """End with an error if no ROS system can run with the environment's settings, or if a simulator runs already."""
    try:
        from ..ros import graph, settings
    except ImportError:  # ROS is not installed yet
        return
    problem = settings.problem()
    if problem:
        refuse(problem)
    name = absolute("", SIMULATOR)
    simulator = starts_simulator and not is_dry_run() and graph.running_node(name, "a simulator")
    if simulator:  # nodes of the same name on one master shut each other down
        how = f"with Ctrl-C in its terminal or with {robocop()} shell rosnode kill {name}"
        refuse(f"{simulator}; stop it {how}, or use another ROS_MASTER_URI")


def launch(given: LaunchArguments, *words: str) -> List[str]:
    """The command line of roslaunch, but with exit status 1 if the simulator fails."""
    if given.is_true("gui") and not x_display.answers():
        refuse("gui:=true: it is a window, and there is no usable display")
    python, quiet = f"{os.environ['ROBOCOP_STATE']}/venv/bin/python", [] if given.verbose else ["--quiet"]
    return [python, f"{ROOT}/launch/robocop_launch.py", *quiet, PACKAGE, given.file.name, *words, *given.words]


def run(arguments: List[str]) -> Plan:
    """Simulator, server, bridge and RViz, or the web page where there is no display."""
    if "--with" in arguments:
        refuse(f"run: --with is an option of sim: {robocop()} sim --with PATH")
    given = LaunchArguments.parse(RUN, arguments)
    # Without a simulator of its own, it uses another's or a real robot.
    require_system(starts_simulator=given.value("sim") not in ("false", "False", "0"))
    parts, words = [part for part in ("gui", "web", "rviz") if given.is_true(part)], []
    if not given.value("rviz"):
        if x_display.answers():
            parts, words = [*parts, "rviz"], ["rviz:=true"]
        elif given.value("web"):
            words = ["rviz:=false"]
            say("no usable display; RViz is not started")
        else:
            parts, words = [*parts, "web"], ["rviz:=false", "web:=true"]
            say("no usable display: the web page takes the place of RViz (web:=false: neither)")
    return parts, launch(given, *words)


def sim(arguments: List[str]) -> Plan:
    """The simulator alone, or with somebody else's package."""
    before, option, after = _split_at(arguments, "--with")
    if not option:
        words = [word for word in arguments if word != "rviz:=false"]  # sim alone starts no RViz
        given = LaunchArguments.parse(SIM, words, "--with")
        require_system()
        return ["gui"] * given.is_true("gui"), launch(given)
    if not after:
        refuse("--with: expected the folder of a catkin package")
    require_system()
    shown = "rviz:=false" not in arguments and x_display.answers()
    web, others = web_arguments([with_absolute_path(word) for word in [*before, *after[1:]]])
    settings = [f"ROBOCOP_RVIZ={str(shown).lower()}", f"ROBOCOP_WEB={' '.join(web)}"]
    program = ["env", *settings, script("robocop_sim_with.py"), os.path.realpath(after[0]), *others]
    return ["hosting", *["rviz"] * shown, *["web"] * bool(web)], program


def _split_at(words: List[str], option: str) -> Tuple[List[str], bool, List[str]]:
    """The words before an option, whether it is there, and the words after it."""
    at = words.index(option) if option in words else len(words)
    return words[:at], option in words, words[at + 1 :]


def web_arguments(words: Sequence[str]) -> Tuple[List[str], List[str]]:
    """The arguments by which aro_sim starts the web page, none unless web:=true is given; and the other words."""
    own = [word for word in words if word.partition(":=")[0] in ("web", "web_host", "web_port")]
    others = [word for word in words if word not in own]
    shown = any(word in [f"web:={true}" for true in TRUE] for word in own)
    return (["robocop_web.py", *(word for word in own if not word.startswith("web:="))] if shown else []), others


def axclient(arguments: List[str]) -> Plan:
    """actionlib's graphical client of the running system's server."""
    if arguments and (len(arguments) != 2 or arguments[0] != "--robot"):
        refuse(f"axclient: expected --robot NAME or nothing, got {' '.join(arguments)}")
    if not is_dry_run() and not x_display.answers():
        refuse(f"axclient: it needs a display, and there is none; {robocop()} goto X Y sends a goal without one")
    action = absolute("".join(arguments[1:]), ACTION)
    return ["axclient"], ["rosrun", "actionlib_tools", "axclient.py", action, ACTION_TYPE]


def record(arguments: List[str]) -> Plan:
    """Record the running system to a bag."""
    if len(arguments) > 1:
        refuse(f"record: expected one file, got {' '.join(arguments)}")
    bag = arguments[0] if arguments else time.strftime("robocop_%Y-%m-%d_%H-%M-%S.bag")
    bag += "" if bag.endswith(".bag") else ".bag"
    for path in (bag, f"{bag}.active"):  # the second is what rosbag leaves if it is killed
        expect_own(Path(path))
    folder = os.path.dirname(os.path.abspath(bag))
    if not (os.path.isdir(folder) and os.access(folder, os.W_OK)):
        refuse(f"record: {folder} is not a folder in which a file can be created")
    require_system(starts_simulator=False)
    say(f"recording to {bag} until Ctrl-C; {robocop()} replay {bag} plays it")
    # Not `rosbag record`, which would be its parent, and if killed leave it running.
    options = ["--quiet", f"--output-name={bag}", "--all", f"--exclude={NOT_RECORDED}"]
    return [], ["rosrun", "rosbag", "record", *options]


def replay(arguments: List[str]) -> Plan:
    """Play a bag in the web page, and in RViz if a display is available."""
    bag = arguments[0] if arguments else ""
    if not bag:
        refuse(f"replay: expected a bag of {robocop()} record or of a report")
    if not is_dry_run() and not os.path.isfile(bag):
        refuse(f"replay: there is no file {bag}")
    rest, option, after = _split_at(arguments[1:], "--start")
    if option:
        rest += [f"start:={''.join(after[:1])}", *after[1:]]
    given = LaunchArguments.parse(REPLAY, rest, "--start")
    for word in given.words:
        name, _, value = word.partition(":=")
        if name in ("start", "rate") and not value.replace(".", "", 1).isdecimal():  # rosbag tells only how it is used
            refuse(f"replay: {name}: expected a number, got {value or 'nothing'}")
    shown = x_display.answers()
    require_system()
    words = [f"bag:={os.path.realpath(bag)}", f"rviz:={str(shown).lower()}"]
    return ["web", *["rviz"] * shown], launch(given, *words)


def grader(command: str, *parts: str) -> Callable[[List[str]], Plan]:
    """A command that grades what its arguments name, if one of them is a file, or a folder with something in it."""

    def grade(arguments: List[str]) -> Plan:
        found = any(os.path.isfile(word) or glob.glob(f"{glob.escape(word)}/*") for word in arguments)
        if not (found or is_dry_run()):
            word = next((word for word in arguments if not word.startswith("-")), "nothing")
            word += " (the folder is empty)" if os.path.isdir(word) else ""
            say(f"{command}: expected a file or folder with something to grade, got: {word}")
            sys.exit(NOT_GRADED)
        return ["hosting", "grade", *parts], [script(f"robocop_{command.replace('-', '_')}.py"), *arguments]

    return grade


def setup(parts: List[str]) -> Plan:
    """Only install and build."""
    known = sorted(path.stem for path in (ROOT / "install" / "deb-packages").glob("*.txt"))
    for part in parts:
        if part not in known:
            refuse(f"setup: there is no part '{part}'; there are: {' '.join(known)}{did_you_mean(part, known)}")
    return parts, ["echo", f"ready in {os.environ['ROBOCOP_STATE']}; {robocop()} run starts the lab"]


def meant(command: str) -> str:
    """The end of the message about an unknown command."""
    if command in ("stop", "kill", "quit", "exit"):
        return "; Ctrl-C in its terminal ends what runs there"
    known = [line.split()[0] for line in HELP.read_text(encoding="utf-8").splitlines() if line[2:3].strip()]
    return did_you_mean(command, known)


def launch_arguments(command: str) -> str:
    """The end of the help for a command: each argument of its launch file."""
    lines = ["\n  Each ARG:=VALUE is one of these; docs/interfaces.md has defaults and ranges:\n"]
    for name, meaning in described(*LAUNCH_FILES[command]).items():
        first = f"    {name}:=".ljust(len(INDENT))
        lines.append(textwrap.fill(" ".join(meaning.split()), 118, initial_indent=first, subsequent_indent=INDENT))
    return "\n".join(lines)


COMMANDS: Dict[str, Callable[[List[str]], Plan]] = {
    "run": run,
    "sim": sim,
    "record": record,
    "replay": replay,
    "axclient": axclient,
    "grade": grader("grade"),
    "grade-class": grader("grade-class", "class"),
    "setup": setup,
}
# What the script asks besides: what to print.
QUESTIONS: Dict[str, Callable[..., str]] = {
    "_meant": meant,
    "_launch_arguments": launch_arguments,
}


def main(words: Sequence[str]) -> None:
    """Print the answer to a command with its arguments, or to a question."""
    command, *arguments = words
    try:
        if command == "doctor":
            sys.exit(doctor.report(*arguments))
        elif command == "_require_modules":
            doctor.require_modules()
        elif command in QUESTIONS:
            print(QUESTIONS[command](*arguments))
        else:
            parts, program = COMMANDS[command](arguments)
            print(" ".join(map(shlex.quote, [*parts, "--", *program])))
    except RobocopError as error:
        refuse(str(error))
