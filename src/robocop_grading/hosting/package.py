"""A path on disk -> the catkin package there, with its launch file and nodes."""

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, List, Optional, Tuple

from aro_robocop_goto_as.errors import HostingError
from aro_robocop_goto_as.ros.names import BRIDGE, SERVER

from . import tree
from .tree import read_xml

NODES = (
    ("robocop_goto_as.py", SERVER),  # the handout's scripts and their node names
    ("robocop_rviz_goto_ac.py", BRIDGE),
)
LAUNCH_FILE = "robocop_goto_as.launch"
GENERATED = {"build", "devel", "install", "logs", "__pycache__"}  # folders of a workspace
SIMULATOR = re.compile(r"aro_sim|robocop_sim")


@dataclass(frozen=True)
class Package:
    """A catkin package to be hosted."""

    name: str
    path: Path
    launch_file: Optional[Path]  # None: its nodes are started directly
    nodes: Tuple[Tuple[str, str], ...]  # script, node name: of the handout's nodes, those present

    @property
    def starts_simulator(self) -> bool:
        """Whether its launch file starts the lab's simulator, itself or by including others of the package."""
        waiting, seen = [self.launch_file] if self.launch_file else [], set()
        while waiting:
            path = waiting.pop()
            seen.add(path)
            root = read_xml(path)
            included = [include.get("file", "") for include in root.iter("include")]
            if any(
                SIMULATOR.search(name) for name in [*included, *(node.get("pkg", "") for node in root.iter("node"))]
            ):
                return True
            own = {found for name in included for found in tree.find(self.path, os.path.basename(name) or "-")}
            waiting += sorted(path for path in own - seen if path.is_file())
        return False


def arguments_of(launch_file: Optional[Path]) -> List[str]:
    """Names of a launch file's arguments, without those that have a fixed value; none without a file."""
    if launch_file is None:
        return []
    return [entry.get("name", "") for entry in read_xml(launch_file).iter("arg") if entry.get("value") is None]


def find_package(path: str, launch: str = "") -> Package:
    """The package at `path`, or the only one below it; if there are several, the one with the lab's name.

    `launch` is the name of the launch file to start. HostingError says what was found instead.
    """
    top = Path(path).expanduser()
    if not top.is_dir():
        raise HostingError(f"{path}: expected the folder of a catkin package, but there is no folder")
    manifests = list(_manifests(top.resolve()))
    if not manifests:
        raise HostingError(f"{path}: no package.xml in it or below it; expected the folder of a catkin package")
    named = [(_name(manifest), manifest.parent) for manifest in manifests]
    chosen = named if len(named) == 1 else [entry for entry in named if entry[0] == "aro_robocop_goto_as"]
    if len(chosen) != 1:
        raise HostingError(
            f"{path}: {len(named)} packages found, give the path of one: "
            + ", ".join(str(folder) for _, folder in named)
        )
    name, folder = chosen[0]
    nodes = tuple((script, node) for script, node in NODES if tree.find(folder, script))
    launch_file = _launch_file(folder, launch)
    if launch_file is None and not nodes:
        raise HostingError(
            f"{folder}: nothing to start: expected launch/{LAUNCH_FILE}, or scripts called "
            + " or ".join(script for script, _ in NODES)
        )
    return Package(name, folder, launch_file, nodes)


def _manifests(top: Path) -> Iterator[Path]:
    """Every package.xml in a folder or below it, except inside another package."""
    for folder, folders, files in tree.walk(top, GENERATED):
        if "package.xml" in files:
            yield folder / "package.xml"
            folders.clear()
        folders[:] = [name for name in folders if not name.startswith(".")]


def _name(manifest: Path) -> str:
    name = read_xml(manifest).findtext("name")
    if not name or not name.strip():
        raise HostingError(f"{manifest}: expected a <name>")
    return name.strip()


def _launch_file(folder: Path, wanted: str) -> Optional[Path]:
    launch_files = sorted(
        path
        for path in tree.find(folder, "*.launch")
        if not any(part.startswith(".") for part in path.relative_to(folder).parts)
    )
    matching = [path for path in launch_files if path.name == (wanted or LAUNCH_FILE)]
    if wanted and not matching:
        known = ", ".join(path.name for path in launch_files) or "none"
        raise HostingError(f"{folder}: no launch file {wanted!r}; available: {known}")
    if matching:
        return matching[0]
    return launch_files[0] if len(launch_files) == 1 else None
