"""robocop sim --with PATH: builds a package in a workspace of its own and runs it against this simulator."""

import argparse
import os
import shlex
import signal
import sys
import zlib
from pathlib import Path
from typing import Dict, List, Optional, Sequence, Tuple
from xml.sax.saxutils import quoteattr

import rospkg

from aro_robocop_goto_as.errors import HostingError, RobocopError
from aro_robocop_goto_as.process.signals import ending_signals, ignore_all, interrupt_on_signal

from . import tree
from .package import Package, arguments_of, find_package
from .scratch import scratch_folder
from .workspace import Environment, build, compat_environment, places

INTERRUPTED = 130  # exit status, as shells have it after Ctrl-C


def host(package: Package, share: Path, state: Path) -> Tuple[Path, Environment]:
    """Build a package in `state`/with/...; that folder, and the environment to run the package in."""
    folder = state / "with" / f"{package.path.name}-{zlib.crc32(os.fsencode(package.path)):08x}"
    environment = build({package.name: package.path}, folder, compat_environment(share, state))
    for script, _ in package.nodes:
        for copy in tree.find(folder / "src" / package.name, script):
            if not os.access(copy, os.X_OK):
                print(
                    f"robocop sim: {copy.relative_to(folder / 'src')} is not executable, so roslaunch could not start "
                    "it. The copy that runs here is made executable; fix the original with: chmod +x",
                    file=sys.stderr,
                    flush=True,
                )
                copy.chmod(0o755)
    # This package's log handlers are not found where a package of the same name is hosted.
    ros_logging = {"ROS_PYTHON_LOG_CONFIG_FILE": os.path.join(rospkg.get_etc_ros_dir(), "python_logging.conf")}
    return folder, {**environment, **ros_logging, "ROBOCOP_WS": os.environ["ROBOCOP_WS"]}


def launch_file(package: Package, folder: Path, arguments: Dict[str, str]) -> Path:
    """A launch file that starts the package and the simulator, written into `folder`."""
    parts = []
    if not package.starts_simulator:
        parts.append('  <include file="$(find aro_sim)/launch/robocop_sim.launch"/>')
    if package.launch_file is not None:
        copy = folder / "src" / package.name / package.launch_file.relative_to(package.path)
        values = "".join(
            f"\n    <arg name={quoteattr(name)} value={quoteattr(value)}/>" for name, value in arguments.items()
        )
        parts.append(f"  <include file={quoteattr(str(copy))}>{values}\n  </include>")
    else:
        parts += [
            f'  <node pkg="{package.name}" type="{script}" name="{node}" output="screen"/>'
            for script, node in package.nodes
        ]
    path = folder / "run.launch"
    path.write_text("\n".join(["<launch>", *parts, "</launch>", ""]))
    return path


def sort_arguments(package: Package, words: List[str], simulator: List[str]) -> Tuple[Dict[str, str], str]:
    """NAME:=VALUE words for the package's launch file, and those for the simulator's, which knows `simulator`."""
    known = arguments_of(package.launch_file)
    for_package: Dict[str, str] = {}
    for_simulator = []
    for word in words:
        name, _, value = word.partition(":=")
        if name in known:
            for_package[name] = value
        elif name in simulator:
            for_simulator.append(word)
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
    parser = argparse.ArgumentParser(prog="robocop sim --with", description=__doc__, allow_abbrev=False)
    parser.add_argument("path", help="folder of a catkin package, or of a workspace with one in it")
    parser.add_argument("--launch", default="", help="which of its launch files (default robocop_goto_as.launch)")
    parser.add_argument("--verbose", action="store_true", help="list all parameters and nodes at the start")
    parser.add_argument("arguments", nargs="*", metavar="NAME:=VALUE", help="for its launch file or the simulator's")
    return parser.parse_intermixed_args(words)


def main() -> None:
    """Build what the arguments name, and launch it in this process, whose end is everything's. Exit status 1 or 130."""
    args = parsed()
    handlers = {number: signal.getsignal(number) for number in ending_signals()}
    interrupt_on_signal()
    try:
        state, share = places()
        package = find_package(args.path, args.launch)
        print(f"robocop sim: building {package.name} from {package.path}", flush=True)
        with scratch_folder():
            folder, environment = host(package, share, state)
        for_package, for_simulator = sort_arguments(
            package, args.arguments, arguments_of(share / "launch" / "robocop_sim.launch")
        )
        path = launch_file(package, folder, for_package)
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
