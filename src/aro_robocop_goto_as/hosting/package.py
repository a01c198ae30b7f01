"""A path on disk -> the catkin package there, with what of it can be started."""

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, List, Optional, Tuple

from ..errors import HostingError
from .files import read_text, read_xml

NODES = (("robocop_goto_as.py", "aro_robocop_goto_as_node"),  # the handout's scripts, and the names of their nodes
         ("robocop_rviz_goto_ac.py", "robocop_rviz_goto_ac_node"))
LAUNCH_FILE = "robocop_goto_as.launch"
LEFT_OUT = {"build", "devel", "install", "logs", "__pycache__"}  # of a workspace: what is made, not written
SIMULATOR = re.compile(r"aro_sim|robocop_sim")


@dataclass(frozen=True)
class Package:
    """A catkin package of somebody's."""

    name: str
    path: Path
    launch_file: Optional[Path]  # None: its nodes are started one by one
    nodes: Tuple[Tuple[str, str], ...]  # script, name of the node: those of the handout's that are there

    @property
    def starts_simulator(self) -> bool:
        """Whether its own launch files bring the lab's simulator up."""
        return self.launch_file is not None and any(
            SIMULATOR.search(read_text(path)) for path in self.path.rglob("*.launch"))

    def launch_arguments(self) -> List[str]:
        """Names of the arguments that its launch file takes."""
        return [] if self.launch_file is None else arguments_of(self.launch_file)


def arguments_of(launch_file: Path) -> List[str]:
    """Names of the arguments that a launch file takes."""
    return [entry.get("name", "") for entry in read_xml(launch_file).iter("arg") if entry.get("value") is None]


def find_package(path: str, launch: str = "") -> Package:
    """The package at `path`, or the only one below it; of several, the one that has the lab's name.

    `launch` names the launch file to start. HostingError says what is there instead.
    """
    top = Path(path).expanduser()
    if not top.is_dir():
        raise HostingError(f"{path}: expected the folder of a catkin package, there is none")
    manifests = list(_manifests(top.resolve()))
    if not manifests:
        raise HostingError(f"{path}: no package.xml in it or below it; expected the folder of a catkin package")
    named = [(_name(manifest), manifest.parent) for manifest in manifests]
    chosen = named if len(named) == 1 else [it for it in named if it[0] == "aro_robocop_goto_as"]
    if len(chosen) != 1:
        raise HostingError(f"{path}: {len(named)} packages are there, give the path of one: "
                           + ", ".join(str(folder) for _, folder in named))
    name, folder = chosen[0]
    nodes = tuple((script, node) for script, node in NODES if any(folder.rglob(script)))
    launch_file = _launch_file(folder, launch)
    if launch_file is None and not nodes:
        raise HostingError(f"{folder}: nothing to start: expected launch/{LAUNCH_FILE}, or scripts called "
                           + " or ".join(script for script, _ in NODES))
    return Package(name, folder, launch_file, nodes)


def _manifests(top: Path) -> Iterator[Path]:
    """Every package.xml in a folder or below it; a package's inside is not searched for more."""
    for folder, folders, files in os.walk(top):
        if "package.xml" in files:
            yield Path(folder, "package.xml")
            folders.clear()
        folders[:] = sorted(name for name in folders if name not in LEFT_OUT and not name.startswith("."))


def _name(manifest: Path) -> str:
    name = read_xml(manifest).findtext("name")
    if not name or not name.strip():
        raise HostingError(f"{manifest}: expected a <name>")
    return name.strip()


def _launch_file(folder: Path, wanted: str) -> Optional[Path]:
    found = sorted(path for path in folder.rglob("*.launch")
                   if not any(part.startswith(".") for part in path.relative_to(folder).parts))
    matching = [path for path in found if path.name == (wanted or LAUNCH_FILE)]
    if wanted and not matching:
        known = ", ".join(path.name for path in found) or "none"
        raise HostingError(f"{folder}: no launch file {wanted!r}; there are: {known}")
    if matching:
        return matching[0]
    return found[0] if len(found) == 1 else None
