"""./robocop COMMAND: checks the arguments, installs what is missing, and becomes the program that does the work.

The shell script `robocop` starts it when nothing may be installed yet, so it uses Python's standard library only.
"""

import math
import os
import subprocess
import sys
import time
from typing import Callable, Dict, List, NoReturn, Sequence, Tuple

from ...errors import MasterError
from ...names import ACTION, ACTION_TYPE, PACKAGE, absolute
from ...probes import master, x_display
from ...suggestions import did_you_mean
from . import completion, container_image, doctor, program
from .launch_arguments import REPLAY, RUN, SIM, TRUE, LaunchArguments
from .program import ROOT, refuse, say

UNKNOWN_COMMAND = 2  # exit status
LOG_LINES = 30
# What rosbag records: full topic names, also of robots with a namespace.
RECORDED = (
    "/(.*/)?(clock|tf|tf_static|scan|odom|ground_truth_odom|joint_states|imu|cmd_vel|map|initialpose"
    "|move_base_simple/goal|robocop_goto_as/.*|world|markers|status|rosout)"
)
SHELL_SETTINGS = """\
[ ! -r ~/.bashrc ] || . ~/.bashrc
PATH={venv}/bin:/usr/bin:/bin:$PATH  # ~/.bashrc may have put another Python first
. {workspace}/setup.bash
[ -n "${{BASH_COMPLETION_VERSINFO:-}}" ] || [ ! -r /usr/share/bash-completion/bash_completion ] \\
  || . /usr/share/bash-completion/bash_completion
. {completion}
PS1="(robocop) $PS1"
"""


def launch(given: LaunchArguments, *words: str) -> NoReturn:
    """Become roslaunch, but with exit status 1 if the simulator fails."""
    quiet = [] if given.verbose else ["--quiet"]
    program.start_launcher(*quiet, PACKAGE, given.file.name, *words, *given.words)


def refuse_second_simulator() -> None:
    """End with an error if a simulator is running: nodes of the same name on one master shut each other down.

    Likewise if something that is no ROS master has the master's port.
    """
    uri = master.master_uri()
    simulator = None if program.is_dry_run() else master.running_simulator(uri)
    if simulator:
        how = "with Ctrl-C in its terminal or with ./robocop shell rosnode kill --all"
        refuse(f"{simulator} on {uri}; stop it {how}, or use another ROS_MASTER_URI")


def run(arguments: List[str]) -> None:
    """Simulator, server, bridge and RViz, or the web page where there is no display."""
    given = LaunchArguments.parse(RUN, arguments)
    program.need()  # also what finds out whether the display answers
    if given.value("sim") not in ("false", "False", "0"):  # without one, it may be another's
        refuse_second_simulator()
    parts = [part for part in ("gui", "web", "rviz") if given.is_true(part)]
    words = []
    if not given.value("rviz"):
        shown = x_display.answers()
        words.append(f"rviz:={str(shown).lower()}")
        if shown:
            parts.append("rviz")
        elif given.value("web"):
            say("no usable display; RViz is not started")
        elif program.set_up("web"):
            say("no usable display; the web page is started instead of RViz (web:=false: neither)")
            words.append("web:=true")
        else:
            say("no usable display; RViz is not started, and the web page could not be installed")
    if parts:
        program.need(*parts)
    launch(given, *words)


def sim(arguments: List[str]) -> None:
    """The simulator alone, or with somebody else's package."""
    if arguments[:1] != ["--with"]:
        given = LaunchArguments.parse(SIM, arguments)
        refuse_second_simulator()
        program.need(*["gui"] * given.is_true("gui"))
        launch(given)
    if len(arguments) < 2:
        refuse("--with: expected the folder of a catkin package")
    shown = "rviz:=false" not in arguments and x_display.answers()
    os.environ["ROBOCOP_RVIZ"] = str(shown).lower()
    web, others = web_arguments(arguments[2:])
    program.need("hosting", *["rviz"] * shown, *["web"] * bool(web))
    os.environ["ROBOCOP_WEB"] = " ".join(web)
    program.start_script("robocop_sim_with.py", os.path.realpath(arguments[1]), *others)


def web_arguments(words: Sequence[str]) -> Tuple[List[str], List[str]]:
    """What aro_sim starts the web page with, nothing unless web:=true is among the words, and the other words."""
    own = [word for word in words if word.partition(":=")[0] in ("web", "web_host", "web_port")]
    others = [word for word in words if word not in own]
    shown = any(word in [f"web:={true}" for true in TRUE] for word in own)
    return (["robocop_web.py", *(word for word in own if not word.startswith("web:="))] if shown else []), others


def axclient(arguments: List[str]) -> None:
    """actionlib's graphical client of the running system's server."""
    if arguments and (len(arguments) != 2 or arguments[0] != "--robot"):
        refuse(f"axclient: expected --robot NAME or nothing, got {' '.join(arguments)}")
    if not program.is_dry_run() and not x_display.answers():
        refuse("axclient: it is a window, and there is no usable display; ./robocop goto X Y sends a goal without one")
    program.need("axclient")
    say("change the numbers under Goal and press SEND GOAL; close the window to end it")
    program.start("rosrun", "actionlib_tools", "axclient.py", absolute("".join(arguments[1:]), ACTION), ACTION_TYPE)


def record(arguments: List[str]) -> None:
    """Record the running system to a bag."""
    if len(arguments) > 1:
        refuse(f"record: expected one file, got {' '.join(arguments)}")
    bag = arguments[0] if arguments else time.strftime("robocop_%Y-%m-%d_%H-%M-%S.bag")
    bag += "" if bag.endswith(".bag") else ".bag"
    if os.path.exists(bag):
        refuse(f"record: {bag} exists; give another name")
    program.need()
    if not program.is_dry_run():
        if not master.master_answers(master.master_uri()):
            refuse("record: no ROS system is running; start ./robocop run in another terminal first")
        say(f"recording to {bag} until Ctrl-C; ./robocop replay {bag} plays it")
    # Not `rosbag record`, which would be its parent, and if killed leave it running.
    program.start("rosrun", "rosbag", "record", "--quiet", f"--output-name={bag}", "--regex", RECORDED)


def _seconds(words: List[str]) -> str:
    """The number after --start."""
    try:
        if math.isfinite(value := float(words[0])) and value >= 0.0:
            return words[0]
    except (IndexError, ValueError):
        pass
    refuse(f"replay: --start: expected seconds after the recording's beginning, got {' '.join(words) or 'nothing'}")


def replay(arguments: List[str]) -> None:
    """Play a bag in the web page, and in RViz if a display is available."""
    bag = arguments[0] if arguments else ""
    if not (program.is_dry_run() and bag) and not os.path.isfile(bag):
        refuse(f"replay: expected a bag of ./robocop record or of a report, got '{bag}'")
    rest = arguments[1:]
    if rest[:1] == ["--start"]:
        rest = [f"start:={_seconds(rest[1:2])}", *rest[2:]]
    given = LaunchArguments.parse(REPLAY, rest)
    shown = x_display.answers()
    program.need("web", *["rviz"] * shown)
    refuse_second_simulator()
    launch(given, f"bag:={os.path.realpath(bag)}", f"rviz:={str(shown).lower()}")


def grade(arguments: List[str]) -> None:
    """Grade a submission; --watch shows it in RViz on a display of this machine, and otherwise in the web page."""
    watch = []
    if "--watch" in arguments:
        # Another machine's display, as with ssh -X, can't be reached from inside the sandbox.
        watch = ["rviz" if os.environ.get("DISPLAY", "").startswith(":") and x_display.answers() else "web"]
    program.need("hosting", "grade", *watch)
    program.start_script("robocop_grade.py", *arguments)


def grade_worker(arguments: List[str]) -> None:
    """A dask worker for grade-class."""
    if any(argument.split("=")[0] == "--nthreads" for argument in arguments):
        program.refuse("grade-worker grades one hand-in at a time: start several instead of --nthreads")
    program.need("hosting", "grade", "class")
    options = "--nthreads 1 --memory-limit 0 --no-dashboard --local-directory".split()
    os.environ["DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED"] = "False"  # see PROFILER in classroom/dask_cluster.py
    folder = str(program.state() / "dask")
    program.start(*program.module("distributed.cli.dask_worker", *options, folder, *arguments))


def test(arguments: List[str]) -> None:
    """Run the tests with pytest."""
    every = "--all" in arguments
    program.need("rviz", "hosting", "grade", "class", "web", "test", *["docs"] * every)
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


def docs(arguments: List[str]) -> None:
    """Build the documentation; a link that leads nowhere is an error."""
    if arguments not in ([], ["--serve"]):
        refuse(f"docs: expected --serve or nothing, got {' '.join(arguments)}")
    program.need("docs")
    site, log = str(program.state() / "docs"), program.state() / "log" / "docs.log"
    build = program.module(
        "mkdocs", "build", "--strict", "--config-file", f"{ROOT}/docs/site/mkdocs.yml", "--site-dir", site
    )
    if program.is_dry_run():
        program.start(*build)
    with open(log, "wb") as output:
        status = subprocess.call(build, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
    if status != 0:
        print("\n".join(log.read_text(errors="replace").splitlines()[-LOG_LINES:]), file=sys.stderr)
        refuse(f"the documentation could not be built (full log: {log})")
    say(f"the documentation is in {site}/index.html")
    if arguments:
        program.start(*program.module("http.server", "--bind", "127.0.0.1", "--directory", site, "0"))


def shell(arguments: List[str]) -> None:
    """Run a command in the workspace, or open a shell in it."""
    program.need()
    if arguments:
        program.start(*arguments)
    settings, words = program.state() / "bashrc", program.state() / "completion.bash"
    if not program.is_dry_run():
        words.write_text(completion.completion(), encoding="utf-8")
        workspace, venv = os.environ["ROBOCOP_WS"], program.state() / "venv"
        settings.write_text(SHELL_SETTINGS.format(venv=venv, workspace=workspace, completion=words), encoding="utf-8")
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
        subprocess.run([program.SCRIPT, "_start", *prebuild], check=True)
    say(f"ready in {program.state()}; ./robocop run starts the lab")


def show_help(commands: List[str]) -> None:
    """What the help text says about commands."""
    for command in commands:
        print(completion.described().get(command) or refuse_unknown(command), end="")


def refuse_unknown(command: str) -> NoReturn:
    """End with an error for a command that does not exist."""
    hint = did_you_mean(command, completion.described())
    say(f"unknown command '{command}' (./robocop help lists them){hint}")
    sys.exit(UNKNOWN_COMMAND)


def clean(arguments: List[str]) -> None:
    """End with an error: the shell script itself removes what was built, if there are none."""
    refuse(f"clean: expected no arguments, got {' '.join(arguments)}")


def to_script(name: str, *parts: str) -> Callable[[List[str]], None]:
    """The command that passes its arguments on to one of the package's scripts, which needs these parts."""

    def start_script(arguments: List[str]) -> None:
        program.need(*parts)
        program.start_script(name, *arguments)

    return start_script


# What the words of help.txt do; without arguments, the shell script does the last two itself.
COMMANDS: Dict[str, Callable[[List[str]], None]] = {
    "run": run,
    "sim": sim,
    "goto": to_script("robocop_goto.py"),
    "record": record,
    "replay": replay,
    "teleop": to_script("robocop_teleop.py"),
    "axclient": axclient,
    "web": to_script("robocop_web.py", "web"),
    "new": to_script("robocop_new.py"),
    "grade": grade,
    "grade-class": to_script("robocop_grade_class.py", "hosting", "grade", "class"),
    "grade-worker": grade_worker,
    "test": test,
    "bench": bench,
    "shell": shell,
    "setup": setup,
    "docs": docs,
    "image": container_image.build,
    "doctor": lambda _: sys.exit(doctor.report(program.SCRIPT, str(ROOT), str(program.state()))),
    "version": lambda _: print(program.version()),
    "--version": lambda _: print(program.version()),
    "completion": lambda _: print(completion.completion(), end=""),
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
        print(completion.described().get(command, ""), end="")
        return
    try:
        COMMANDS[command](arguments)
    except MasterError as error:
        refuse(str(error))
