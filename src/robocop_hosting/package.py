"""A path on disk -> the catkin package there, with its launch file and nodes."""

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Collection, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple
from xml.etree.ElementTree import Element

from aro_robocop_goto_as.names import PACKAGE

from . import tree
from .errors import HostingError
from .launch_file import LaunchNode, read
from .scripts import ASIDE, PART_OF, Choice, choose, files_below
from .tree import read_bytes, read_xml
from .workspace import COMPAT, Environment

LAUNCH_FILE = "robocop_goto_as.launch"
NAME = re.compile(r"[A-Za-z0-9][\w-]*", re.ASCII)  # of a package, as catkin takes it
MAX_NAMED = 10  # scripts in a message
SIMULATOR = "aro_sim"  # the lab's package that starts its simulator ...
OWN_SIMULATOR = PACKAGE, "robocop_sim.py"  # ... and the node of this package that is started then
VIEWERS = {"rviz", "rqt_gui", "rqt_graph", "rqt_plot", "rqt_image_view", SIMULATOR}  # packages that nothing depends on
SOURCE_SPACE = "src"  # catkin's name for the folder of a workspace's packages


@dataclass(frozen=True)
class Package:
    """A catkin package to be hosted."""

    name: str
    path: Path
    launch_file: Optional[Path]  # None: its nodes are started directly
    launch_files: Sequence[Path]  # all of them, this one first
    others: Mapping[str, Path]  # the packages that are built with it, by name

    @property
    def sources(self) -> Dict[str, Path]:
        """The packages to be built, by name."""
        return {self.name: self.path, **self.others}


def arguments_of(launch_file: Optional[Path]) -> List[str]:
    """Names of a launch file's arguments, except arguments with a fixed value; none if there is no file."""
    if launch_file is None:
        return []
    return [entry.get("name", "") for entry in read_xml(launch_file).iter("arg") if entry.get("value") is None]


def find_package(path: str, launch: str = "", grades: bool = True) -> Package:
    """The package at `path`, or below it; of several the one with the lab's name, or with something to start.

    `launch` is the name of the launch file to start. A package is graded with those below `path` on which it depends,
    and run with its whole workspace, as by catkin_make. HostingError says what was found instead.
    """
    top = Path(path).expanduser()
    if not top.is_dir():
        raise HostingError(f"{path}: expected the folder of a catkin package, but there is no folder")
    top = top.resolve()
    named = _packages(top)
    if not named:
        raise HostingError(
            f"{path}: no package.xml in it or below it (folders with CATKIN_IGNORE are left out); expected a package"
        )
    name, folder = _chosen(path, named, launch)
    if not NAME.fullmatch(name):
        raise HostingError(f"{folder}/package.xml: expected a <name> of letters, digits, _ and -, got {name!r}")
    launch_file, launch_files = _launch_file(folder, launch)
    others = ", ".join(path.name for path in launch_files[:MAX_NAMED])
    if launch_files and launch_file is None and not grades:
        raise HostingError(f"{folder}: no {LAUNCH_FILE}, but several launch files: add --launch NAME, of {others}")
    if launch_file is None and not choose(folder):
        scripts = [str(path.relative_to(folder)) for path in files_below(folder) if path.suffix == ".py"]
        raise HostingError(
            f"{folder}: nothing to start: expected launch/{LAUNCH_FILE}, or scripts called {' or '.join(PART_OF)}, "
            f"or one that makes an action server; found: {', '.join(scripts[:MAX_NAMED]) or 'no Python script'}"
            + (f", and launch files: {others}" if others else "")
        )
    if grades:
        return Package(name, folder, launch_file, launch_files, _needed(folder, _beside(name, named)))
    source = next((it for it in top.parents if it.name == SOURCE_SPACE), top) if folder == top else top
    return Package(name, folder, launch_file, launch_files, _beside(name, _packages(source)))


def _packages(top: Path) -> List[Tuple[str, Path]]:
    """Names and folders of the packages at `top` or below it, without those of ROS 2 and those that compat/ replaces.

    HostingError if there are only ones of ROS 2.
    """
    manifests = {manifest: read_xml(manifest) for manifest in _manifests(top)}
    types = {
        it: {(element.text or "").strip() for element in root.iter("build_type")} for it, root in manifests.items()
    }
    left = [it for it in manifests if not all(name.startswith("ament") for name in types[it] or [""])]
    if manifests and not left:
        ament = next(iter(manifests))
        raise HostingError(
            f"{ament}: this is a package of ROS 2 (build type {', '.join(types[ament])}), and here is ROS 1: use its "
            "branch for ROS noetic, if it has one (git branch -r)"
        )
    named = [(_name(it, manifests[it]), it.parent) for it in left]
    return [entry for entry in named if entry[0] not in COMPAT] or named


def _beside(name: str, named: Sequence[Tuple[str, Path]]) -> Dict[str, Path]:
    """The packages that can be built with the package called `name`, by name: of several of a name the first."""
    return {it: path for it, path in reversed(named) if it not in (name, *COMPAT) and NAME.fullmatch(it)}


def _chosen(path: str, named: Sequence[Tuple[str, Path]], launch: str) -> Tuple[str, Path]:
    """Name and folder of the one of these packages that is meant; HostingError if nothing says which."""
    top = Path(path).expanduser().resolve()
    rules: Sequence[Callable[[str, Path], bool]] = (
        lambda name, folder: bool(launch) and can_start(folder, launch),
        lambda name, folder: name == PACKAGE,
        lambda name, folder: not ASIDE.search(str(folder.relative_to(top))),
        lambda name, folder: can_start(folder, launch),
    )
    left = list(named)
    for rule in rules:
        if len(left) > 1:
            left = [entry for entry in left if rule(*entry)] or left
    if len(left) > 1:
        shown = (f"{folder} ({name}: {_launch_names(folder)})" for name, folder in left[:MAX_NAMED])
        raise HostingError(f"{path}: {len(left)} packages found, give the path of one: {', '.join(shown)}")
    return left[0]


def can_start(folder: Path, launch: str) -> bool:
    """Return whether a package has the launch file of this name, or without a name something that would be started."""
    try:
        return _launch_file(folder, launch)[0] is not None or bool(choose(folder))
    except HostingError:
        return not launch  # several files could be the one: that is reported if the package is chosen


def _launch_names(folder: Path) -> str:
    names = sorted({path.name for path in files_below(folder) if path.suffix == ".launch"})
    return ", ".join(names[:MAX_NAMED]) or "no launch file"


def _needed(folder: Path, others: Mapping[str, Path]) -> Mapping[str, Path]:
    """Those of the other packages on which the one in `folder` depends, directly or not."""
    needed: Dict[str, Path] = {}
    waiting = [folder]
    while waiting:
        root = read_xml(waiting.pop() / "package.xml")
        depends = {(element.text or "").strip() for element in root if element.tag.endswith("depend")}
        found = {other: path for other, path in others.items() if other in depends and other not in needed}
        needed.update(found)
        waiting += found.values()
    return needed


def _manifests(top: Path) -> Iterator[Path]:
    """Every package.xml in a folder or below it, except inside another package, or where catkin ignores all."""
    for folder, folders, files in tree.walk(top, tree.GENERATED):
        if "CATKIN_IGNORE" in files:
            folders.clear()
        elif "package.xml" in files:
            yield folder / "package.xml"
            folders.clear()
        folders[:] = [name for name in folders if not name.startswith(".")]


def _name(manifest: Path, root: Element) -> str:
    name = root.findtext("name")
    if not name or not name.strip():
        raise HostingError(f"{manifest}: expected a <name>")
    return name.strip()


def _launch_file(folder: Path, wanted: str) -> Tuple[Optional[Path], List[Path]]:
    """The launch file to start, and all launch files; HostingError if several different files have its name."""
    files = [path for path in files_below(folder) if path.suffix == ".launch"]
    doubts = {it: (bool(ASIDE.search(str(it.relative_to(folder)))), it.parent.name != "launch") for it in files}
    files.sort(key=lambda path: (doubts[path], path))
    matching = [path for path in files if path.name == (wanted or LAUNCH_FILE)]
    if wanted and not matching:
        known = ", ".join(sorted(path.name for path in files)) or "none"
        raise HostingError(f"{folder}: no launch file {wanted!r}; available: {known}")
    for path in matching[1:]:
        if doubts[path] == doubts[matching[0]] and read_bytes(path) != read_bytes(matching[0]):
            names = " and ".join(str(it.relative_to(folder)) for it in (matching[0], path))
            raise HostingError(f"{names}: nothing says which of them is to be started: remove one")
    if matching or len(files) == 1:
        chosen = (matching or files)[0]
        return chosen, [chosen, *(path for path in files if path != chosen)]
    return None, files


@dataclass(frozen=True)
class LaunchPlan:
    """What roslaunch would start of a package, by part; the parameters it would set; what the grader does not do."""

    choices: Mapping[str, Choice]
    parameters: Mapping[str, Any]
    notes: Sequence[str]
    others: Sequence[LaunchNode] = ()  # of other packages, which the package's own launch file starts

    @property
    def starts_simulator(self) -> bool:
        """Return whether the package's own launch file starts the lab's simulator."""
        return any(node.package == SIMULATOR or (node.package, node.type) == OWN_SIMULATOR for node in self.others)


def read_launch_plan(
    package: Package, folder: Path, environment: Environment, arguments: Sequence[str] = ()
) -> LaunchPlan:
    """Read the launch files of a package that is built in the workspace at `folder`: the package's own one, then others
    until server and bridge are found. `arguments`: NAME:=VALUE, for the first. HostingError says what is wrong.
    """
    copy = Path(os.path.realpath(folder / "src" / package.name))  # the package itself if that is a link
    relays = [path for path in files_below(folder / "devel" / "lib" / package.name) if path.is_file()]
    nodes: List[LaunchNode] = []
    parameters: Dict[str, Any] = {}
    notes: List[str] = []
    others: Sequence[LaunchNode] = ()
    for path in package.launch_files:
        is_main = path == package.launch_file
        try:
            file = read(copy / path.relative_to(package.path), copy, environment, arguments if is_main else ())
        except HostingError:
            if is_main:
                raise
            continue  # it may need packages that only another machine has
        if is_main:
            others = [node for node in file.nodes if node.package != package.name]
        choices = choose(copy, [*nodes, *file.nodes], relays, expects_one=False)
        if is_main or any(choice.node in file.nodes for choice in choices.values()):
            nodes += file.nodes
            parameters = {**file.parameters, **parameters}
            names = {it.name for it in (*files_below(copy), *relays)}
            notes += [*file.warnings, *_not_done(package, file.nodes, choices, names)]
        if all(part in choices and choices[part].node is not None for part in PART_OF.values()):
            break
    return LaunchPlan(choose(copy, nodes, relays), parameters, notes, others)


def _not_done(
    package: Package, nodes: Sequence[LaunchNode], choices: Mapping[str, Choice], names: Collection[str]
) -> Iterator[str]:
    """Notes about requests of launch files that are not carried out; `names`: the names of the package's files."""
    graded = [choice.node for choice in choices.values()]
    for node in (node for node in nodes if node.is_own):
        if node.package == package.name and node.type not in names:
            yield f"{node.location}: roslaunch finds no {node.type} in this package"
        elif node not in graded and node.package not in VIEWERS:
            yield (
                f"{node.location}: node {node.name} ({node.package} {node.type}) is not started: server and bridge are "
                "graded one at a time, each alone"
            )
        elif node in graded and node.package != package.name:
            yield f"{node.location}: pkg={node.package!r} is not this package, whose name is {package.name!r}"
        for attribute in node.not_done if node in graded else ():
            yield f"{node.location}: {attribute} has no effect in a grading"
