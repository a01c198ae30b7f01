"""robocop sim --with PATH: somebody's package, built in a workspace of its own, against this simulator."""

import argparse
import os
import shlex
import sys
import zlib
from pathlib import Path
from typing import Dict, List, Tuple
from xml.sax.saxutils import quoteattr

from ..errors import HostingError, RobocopError
from .compat import compat_environment
from .package import Package, arguments_of, find_package
from .workspace import Environment, build


def host(package: Package, share: Path, state: Path) -> Tuple[Path, Environment]:
    """Build a package in `state`/with/...; that folder, and the environment to run the package in."""
    folder = state / "with" / f"{package.path.name}-{zlib.crc32(os.fsencode(package.path)):08x}"
    environment = build({package.name: package.path}, folder, compat_environment(share, state))
    for script, _ in package.nodes:
        for copy in (folder / "src" / package.name).rglob(script):
            if not os.access(copy, os.X_OK):
                where = copy.relative_to(folder / "src")
                print(f"robocop sim: {where} is not executable, so roslaunch could not start it; in the copy that runs "
                      "here it is. Mend it with: chmod +x", file=sys.stderr, flush=True)
                copy.chmod(0o755)
    return folder, {**environment, "ROBOCOP_WS": os.environ["ROBOCOP_WS"]}


def launch_file(package: Package, folder: Path, arguments: Dict[str, str]) -> Path:
    """A launch file that starts all of it, written into `folder`."""
    parts = []
    if not package.starts_simulator:
        parts.append('  <include file="$(find aro_sim)/launch/robocop_sim.launch"/>')
    if package.launch_file is not None:
        copy = folder / "src" / package.name / package.launch_file.relative_to(package.path)
        given = "".join(f"\n    <arg name={quoteattr(name)} value={quoteattr(value)}/>"
                        for name, value in arguments.items())
        parts.append(f"  <include file={quoteattr(str(copy))}>{given}\n  </include>")
    else:
        parts += [f'  <node pkg="{package.name}" type="{script}" name="{node}" output="screen"/>'
                  for script, node in package.nodes]
    path = folder / "run.launch"
    path.write_text("\n".join(["<launch>", *parts, "</launch>", ""]))
    return path


def sort_arguments(package: Package, given: List[str], simulator: List[str]) -> Tuple[Dict[str, str], str]:
    """NAME:=VALUE for the package's own launch file, and those for the simulator's, which takes `simulator`."""
    taken = package.launch_arguments()
    own: Dict[str, str] = {}
    others = []
    for word in given:
        name, _, value = word.partition(":=")
        if name in taken:
            own[name] = value
        elif name in simulator:
            others.append(word)
        else:
            raise HostingError(f"{word}: neither {package.name}'s launch file nor the simulator takes an argument of "
                               f"that name; they take: {', '.join([*taken, *simulator])}")
    if "rviz" in taken:
        own.setdefault("rviz", os.environ.get("ROBOCOP_RVIZ", "true"))
    return own, shlex.join(others)


def prepare() -> Tuple[Path, Environment]:
    """By this program's arguments: the launch file of it all, and the environment for it. Exits with 1 if it can't."""
    parser = argparse.ArgumentParser(prog="robocop sim --with", description=__doc__)
    parser.add_argument("path", help="folder of a catkin package, or of a workspace with one in it")
    parser.add_argument("--launch", default="", help="which of its launch files (default robocop_goto_as.launch)")
    parser.add_argument("arguments", nargs="*", metavar="NAME:=VALUE", help="for its launch file or the simulator's")
    args = parser.parse_args()
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    try:
        package = find_package(args.path, args.launch)
        print(f"robocop sim: building {package.name} from {package.path}", flush=True)
        folder, environment = host(package, share, state)
        own, others = sort_arguments(package, args.arguments, arguments_of(share / "launch" / "robocop_sim.launch"))
        path = launch_file(package, folder, own)
    except RobocopError as error:
        print(f"robocop sim: {error}", file=sys.stderr)
        sys.exit(1)
    return path, {**environment, "ROBOCOP_SIM_ARGS": others}
