"""What was handed in -> the parts of the lab found there, built, with the commands that start them."""

import functools
import sys
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.names import PACKAGE
from robocop_hosting import workspace
from robocop_hosting.errors import HostingError
from robocop_hosting.package import MAX_NAMED, LaunchPlan, Package, find_package, read_launch_plan
from robocop_hosting.scripts import (
    FIRST_LINE,
    HAS_BYTE_ORDER_MARK,
    NOT_EXECUTABLE,
    PART_OF,
    Choice,
    candidates,
    choose,
    files_below,
    interpreter,
    listens_to_clicks,
    part_of,
    start_problems,
)
from robocop_hosting.tree import read_text
from robocop_hosting.workspace import CPP, Environment, compat_environment, places

from .advice import advice
from .errors import GradingError
from .files.exports import SEVERAL, holds_class
from .new import SKELETON, make
from .sandbox.bubblewrap import AGENT

CHANNEL = "CHANNEL"  # stands for the argument with which the agent reaches the grader


@dataclass(frozen=True)
class Script:
    """One of the lab's two nodes."""

    part: str  # server or bridge
    path: Path
    arguments: List[str] = field(default_factory=list)
    variables: Mapping[str, str] = field(default_factory=dict)  # of its environment, from its launch file
    shown: str = ""  # its path within the submission, and what starts it

    def command(self) -> List[str]:
        """The command line, with this interpreter whatever the script's first line says: students' Pythons differ."""
        return [sys.executable, str(AGENT), CHANNEL, str(self.path), *self.arguments]


@dataclass(frozen=True)
class Submission:
    """A server, a bridge or both, ready to be run."""

    name: str
    environment: Environment
    scripts: List[Script]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    notes: Sequence[str] = ()  # what may fail in the lab and does not affect the grade
    reads: Sequence[Path] = ()  # what it needs to read, besides the system and what every submission needs
    archive: Optional[Path] = None  # its files for a sandbox, packed; None: they are where its scripts are
    beside: Sequence[str] = ()  # names of what lies beside a single file, which was not handed in

    @property
    def files(self) -> List[str]:
        """Which files are graded, in words."""
        return [f"{script.part}: {script.shown}" for script in self.scripts]


def find(top: Path, folder: Path, environments: Mapping[str, Environment]) -> Submission:
    """The submission at `top`; a package is built in `folder`, on the environment of its name, or else of "".

    GradingError or HostingError says why there is none.
    """
    if top.is_file():
        part = part_of(top)
        if not part:
            raise GradingError(
                f"{top}: neither a server nor a bridge: it contains no ActionServer, no action client and no "
                "/move_base_simple/goal"
            )
        return _loose({part: Choice(top, None, False, [])}, top, environments[""])
    sources = [str(file.relative_to(top)) for file in files_below(top) if file.suffix in CPP]
    try:
        submission = _folder(top, folder, environments)
    except (GradingError, HostingError) as error:
        if not sources:
            raise
        raise GradingError(f"{_about_cpp(sources)}\n{error}") from error
    return replace(submission, notes=[*submission.notes, _about_cpp(sources)]) if sources else submission


def _about_cpp(sources: Sequence[str]) -> str:
    return f"{', '.join(sources[:MAX_NAMED])}: C++ is not graded, only a server and a bridge in Python"


def _folder(top: Path, folder: Path, environments: Mapping[str, Environment]) -> Submission:
    """A package, or a folder with single files."""
    try:
        has_package = any(file.name == "package.xml" for file in files_below(top))
        choices = {} if has_package else choose(top)
        package = None if choices else find_package(str(top))
    except HostingError as error:
        if not holds_class(top):
            raise
        raise HostingError(f"{error}; {SEVERAL}") from error
    if package is None:
        return _loose(choices, top, environments[""])
    submission = _package(package, folder, environments)
    outside = [it for it in candidates(top) if package.path not in it.path.parents]
    notes = [f"{it.part}: {it.path.relative_to(top)} is outside of the package, so it is not graded" for it in outside]
    return replace(submission, name=top.name, notes=[*submission.notes, *notes])


def _loose(choices: Mapping[str, Choice], top: Path, environment: Environment) -> Submission:
    """Single files in `top`, run in place, on top of the skeleton's package."""
    folder = top.parent if top.is_file() else top
    return _ready(top.name, folder, environment, LaunchPlan(choices, {}, ()), is_loose=True)


def _ready(name: str, top: Path, environment: Environment, found: LaunchPlan, is_loose: bool = False) -> Submission:
    scripts = [_script(part, choice, top) for part, choice in found.choices.items()]
    notes = list(found.notes)
    if [script.part for script in scripts] == ["server"] and listens_to_clicks(scripts[0].path):
        file = scripts[0].path.name
        notes.append(f"bridge: not graded: {file} has a bridge, too; only one with a script of its own can be graded")
    for script in scripts:
        others = ", ".join(str(other.relative_to(top)) for other in found.choices[script.part].others)
        notes += [f"{script.part}: {script.path.relative_to(top)} is graded, but not {others}"] if others else []
        notes += _start_problems(script.part, found.choices[script.part], is_loose)
        notes += [f"{script.part}: {script.path.name}, {text}" for text in advice(read_text(script.path))]
    return Submission(name, environment, scripts, found.parameters, notes)


def _script(part: str, choice: Choice, top: Path) -> Script:
    node, name = choice.node, str(choice.path.relative_to(top))
    shown = name if node is None else f"{name}, started by {node.location}"
    return Script(
        part,
        choice.path,
        [] if node is None else [*node.arguments, f"__name:={node.name}"],  # without a launch file as by rosrun
        {} if node is None else node.variables,
        shown,
    )


@functools.lru_cache(maxsize=None)  # the same folder all the time, even if the sources change meanwhile
def lab_folder(share: Path, state: Path) -> Path:
    """The workspace of the skeleton's package."""
    return workspace.folder_for(state / "grade" / "lab", SKELETON, share / "compat")


def build_environments(share: Path, state: Path) -> Dict[str, Environment]:
    """What packages are built on, by their names; "" for any other than the lab's, on top of its action. Built once."""
    folder, underlay = lab_folder(share, state), compat_environment(share, state)

    def build_lab() -> Environment:
        with tempfile.TemporaryDirectory() as source:
            make(Path(source, PACKAGE))
            return workspace.build({PACKAGE: Path(source, PACKAGE)}, folder, underlay)

    return {PACKAGE: underlay, "": workspace.build_once(folder, underlay, build_lab)}


def _package(package: Package, folder: Path, environments: Mapping[str, Environment]) -> Submission:
    underlay = environments.get(package.name, environments[""])
    environment = workspace.build(package.sources, folder, underlay)
    copy = folder / "src" / package.name
    found = read_launch_plan(package, folder, environment)
    if not found.choices:
        names = [str(path.relative_to(copy)) for path in files_below(copy) if path.suffix == ".py"]
        raise GradingError(
            f"{package.path}: nothing to grade: expected scripts called {' or '.join(PART_OF)}, or started by the "
            f"launch file; found: {', '.join(names[:MAX_NAMED]) or 'no Python script'}"
        )
    return _ready(package.path.name, copy, environment, found)


def _start_problems(part: str, choice: Choice, is_loose: bool) -> Iterator[str]:
    """Why roslaunch could not start a script that is started here by its interpreter.

    `is_loose`: the script is not in a package, so copying may have dropped its execute bit.
    """
    name = choice.path.name
    for problem, remedy in start_problems(choice.path):
        if is_loose and problem == NOT_EXECUTABLE:
            continue
        result = "so roslaunch can't start it in the lab"
        if choice.is_installed and problem != HAS_BYTE_ORDER_MARK:
            result = "so the lab starts it only by way of catkin_install_python"
        yield f"{part}: {name} {problem}, {result}: {remedy}"
    if interpreter(choice.path) and not choice.is_installed:
        yield (
            f"{part}: {name} is started by {interpreter(choice.path)!r}, which the lab may not have: make {FIRST_LINE} "
            "its first line"
        )


def main() -> None:
    """Build what the first grading would build: the lab's action and compat/. Exit status 1 if that fails."""
    try:
        state, share = places()
        build_environments(share, state)
    except RobocopError as error:
        sys.exit(f"robocop setup: {error}")


if __name__ == "__main__":
    main()
