"""robocop sim --with PATH: builds a package in a workspace of its own and runs it against this simulator."""

import argparse
import os
import re
import shlex
import signal
import sys
from pathlib import Path
from typing import Dict, List, Optional, Sequence, Tuple
from xml.sax.saxutils import quoteattr

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.process.signals import ending_signals, ignore_all, interrupt_on_signal
from aro_robocop_goto_as.process.start import typed

from .errors import HostingError
from .package import LaunchPlan, Package, arguments_of, find_package, read_launch_plan
from .scratch import scratch_folder
from .scripts import FIRST_LINE, NODE_NAMES, interpreter, start_problems
from .workspace import Environment, build_in_place, compat_environment, exclusive, places, workspace_name

LACKING = re.compile("can't be built|not found|No such file")
ABOUT_LACKING = (
    "What is not found has to be installed, or to lie in the same workspace. Gazebo is not here, this simulator takes "
    "its place. --launch NAME starts another launch file; a file CATKIN_IGNORE in a package's folder leaves it out."
)
AS_ROSRUN = quoteattr("bash -c 'exec \"$0\"'")  # without the arguments that roslaunch appends, such as __name:=...
INTERRUPTED = 130  # exit status, as shells have it after Ctrl-C


def host(package: Package, share: Path, state: Path, arguments: Dict[str, str]) -> Tuple[Path, Environment, LaunchPlan]:
    """Build a package in `state`/with/...; return that folder, its environment, and what its launch file starts.

    HostingError if roslaunch can't start one of its scripts, with the reason.
    """
    folder = state / "with" / workspace_name(package.path)
    words = [f"{name}:={value}" for name, value in arguments.items()]
    try:
        with exclusive(folder):
            environment = build_in_place(package.sources, folder, compat_environment(share, state))
            found = read_launch_plan(package, folder, environment, words)
    except HostingError as error:
        raise HostingError(f"{error}\n{ABOUT_LACKING}" if LACKING.search(str(error)) else str(error)) from error
    for choice in found.choices.values():
        if not choice.is_installed and (choice.node is not None or package.launch_file is None):
            expect_startable(choice.path)
    return folder, {**environment, "ROBOCOP_WS": os.environ["ROBOCOP_WS"]}, found


def expect_startable(script: Path) -> None:
    """HostingError if roslaunch can't start this script, with the remedy."""
    for problem, remedy in start_problems(script):
        raise HostingError(f"{script} {problem}, so roslaunch can't start it: {remedy}")
    program = interpreter(script)
    if program:
        _tell(f"{script} is started by {program!r}, which the lab may not have: make {FIRST_LINE} its first line")


def _tell(words: str) -> None:
    print(f"robocop sim: {words}", file=sys.stderr, flush=True)


def write_launch_file(package: Package, folder: Path, arguments: Dict[str, str], found: LaunchPlan) -> Path:
    """Write a launch file into `folder` that starts the package and, unless the package does so, the simulator."""
    parts = []
    if not found.starts_simulator:
        parts.append('  <include file="$(find aro_sim)/launch/robocop_sim.launch"/>')
    if package.launch_file is not None:
        values = "".join(
            f"\n    <arg name={quoteattr(name)} value={quoteattr(value)}/>" for name, value in arguments.items()
        )
        parts.append(f"  <include file={quoteattr(str(package.launch_file))}>{values}\n  </include>")
    else:
        for part, choice in found.choices.items():
            script = f"type={quoteattr(choice.path.name)} name={quoteattr(NODE_NAMES[part])}"
            parts.append(f"  <node pkg='{package.name}' {script} launch-prefix={AS_ROSRUN} output='screen'/>")
    path = folder / "run.launch"
    path.write_text("\n".join(["<launch>", *parts, "</launch>", ""]))
    return path


def sort_arguments(package: Package, words: List[str], simulator: List[str]) -> Tuple[Dict[str, str], str]:
    """The NAME:=VALUE words for the package's launch file, and those for the simulator, which knows `simulator`.

    rviz:=... goes into the environment, for aro_sim, if the launch file has no such argument.
    """
    known = arguments_of(package.launch_file)
    for_package: Dict[str, str] = {}
    for_simulator: List[str] = []
    for word in words:
        name, given, value = word.partition(":=")
        if not given:
            raise HostingError(f"expected NAME:=VALUE, such as world:=stage_1; got '{word}'")
        if name in known:
            for_package[name] = value
        elif name in simulator:
            for_simulator.append(word)
        elif name == "rviz":
            os.environ["ROBOCOP_RVIZ"] = value  # for aro_sim, which opens RViz unless this is false
        else:
            raise HostingError(
                f"{word}: neither {package.name}'s launch file nor the simulator's has an argument of this name; "
                f"they have: {', '.join([*known, *simulator])}"
            )
    if "rviz" in known:
        for_package.setdefault("rviz", os.environ.get("ROBOCOP_RVIZ", "true"))
    return for_package, shlex.join(for_simulator)


def parsed(words: Optional[Sequence[str]] = None) -> argparse.Namespace:
    """The command line, whose options and NAME:=VALUE words may come in any order."""
    parser = argparse.ArgumentParser(prog=typed("sim --with"), description=__doc__, allow_abbrev=False)
    parser.add_argument("path", help="folder of a catkin package, or of a workspace with one in it")
    parser.add_argument("--launch", default="", help="which of its launch files (default robocop_goto_as.launch)")
    parser.add_argument("--verbose", action="store_true", help="list all parameters and nodes at the start")
    parser.add_argument("arguments", nargs="*", metavar="NAME:=VALUE", help="for its launch file or the simulator's")
    return parser.parse_intermixed_args(words)


def main() -> None:
    """Build and launch the package that the arguments name; everything ends with this process. Exit status 1 or 130."""
    args = parsed()
    handlers = {number: signal.getsignal(number) for number in ending_signals()}
    interrupt_on_signal()
    try:
        state, share = places()
        package = find_package(args.path, args.launch, grades=False)
        for_package, for_simulator = sort_arguments(
            package, args.arguments, arguments_of(share / "launch" / "robocop_sim.launch")
        )
        shown = os.fsencode(package.path).decode(errors="replace")
        print(f"robocop sim: building {package.name} from {shown}", flush=True)
        with scratch_folder():
            folder, environment, found = host(package, share, state, for_package)
        path = write_launch_file(package, folder, for_package, found)
    except RobocopError as error:
        print(f"robocop sim: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        ignore_all()
        sys.exit(INTERRUPTED)
    for number, handler in handlers.items():
        signal.signal(number, handler)
    environment.pop("TMPDIR", None)  # the build's
    tmpdir = {"TMPDIR": os.environ["TMPDIR"]} if "TMPDIR" in os.environ else {}
    # Not in a new process: in the hosted package's environment this package might not be found.
    from aro_robocop_goto_as.ros.cli import launch  # needs ROS, which the tests of this module do not

    os.environ.clear()
    os.environ.update({**environment, **tmpdir, "ROBOCOP_SIM_ARGS": for_simulator})
    launch.main([*([] if args.verbose else ["--no-summary"]), "--overview", str(path)])
