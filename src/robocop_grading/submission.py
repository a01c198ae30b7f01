"""A path -> the parts of the lab found there, built, with the commands that start them."""

import contextlib
import io
import os
import re
import shutil
import sys
import tempfile
import tokenize
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Set

import yaml

from aro_robocop_goto_as.errors import GradingError, RobocopError

from .advice import advice, next_todo
from .hosting import tree, workspace
from .hosting.package import NODES, Package, find_package
from .hosting.tree import read_bytes, read_text, read_xml
from .hosting.workspace import Environment, compat_environment, places
from .sandbox.bubblewrap import Sandbox, expect_private
from .sandbox.build import build, runner_in
from .skeleton import make

LAB = "aro_robocop_goto_as"
AGENT = Path(__file__).resolve().parent / "agent"
CHANNEL = "CHANNEL"  # stands for the argument with which the agent reaches the grader
PARTS = dict(zip((script for script, _ in NODES), ("server", "bridge")))  # by script
NODE_NAMES = {PARTS[script]: node for script, node in NODES}  # by part
SERVERS, CLIENTS = {"SimpleActionServer", "ActionServer"}, {"SimpleActionClient", "ActionClient"}
CLICKS = "move_base_simple"
LAUNCH_TIME = 30.0  # [s] of processor time
DEEPEST = 20  # nested lists and mappings of a parameter
MOST_SHOWN = 200  # characters of a parameter in a message
TYPES = "expected a boolean, a 32-bit number, a string, or a list or mapping of these"
MAX_PARAMETERS = 100_000  # bytes of roslaunch's output


@dataclass(frozen=True)
class Script:
    """One of the lab's two nodes."""

    part: str  # server or bridge
    path: Path
    node: str  # name
    arguments: List[str] = field(default_factory=list)
    next_step: str = ""  # in a program that still has TODOs of the skeleton

    def command(self) -> List[str]:
        """Its command line, with this interpreter whatever its first line says: students' Pythons differ."""
        return [sys.executable, str(AGENT), CHANNEL, str(self.path), *self.arguments, f"__name:={self.node}"]


@dataclass(frozen=True)
class Submission:
    """A server, a bridge or both, ready to be run."""

    name: str
    reads: Sequence[Path]  # what it needs to read, besides the system and what every submission needs
    environment: Environment
    scripts: List[Script]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    notes: Sequence[str] = ()  # what may fail in the lab and does not affect the grade


def prepare_submission(path: str, share: Path, state: Path, builds: Path, sandbox: Optional[Sandbox]) -> Submission:
    """The submission at `path`; a package is built, in the sandbox, in a folder of its own below `builds`.

    GradingError or HostingError says why there is none.
    """
    top = Path(os.path.realpath(Path(path).expanduser()))  # resolve() raises at links in a circle, up to Python 3.12
    if sandbox is not None:
        expect_private(top)
    if top.is_file():
        return _files([top], top, share, state)
    if not top.is_dir():
        raise GradingError(f"{path}: expected a package, a server's or a bridge's file, but nothing is there")
    loose = [next(iter(tree.find(top, script)), top) for script in PARTS]
    if loose != [top, top] and not tree.find(top, "package.xml"):
        return _files([path for path in loose if path != top], top, share, state)
    return _package(find_package(str(top)), share, state, builds, sandbox)


def _files(paths: List[Path], top: Path, share: Path, state: Path) -> Submission:
    """Single files in `top`, run in place, on top of the skeleton's package."""
    scripts: List[Script] = []
    for path in paths:
        if not path.is_file() or top not in (path.resolve(), *path.resolve().parents):
            raise GradingError(f"{path}: expected a file, not a link to one elsewhere")
        part = _part_of(path, top if top.is_dir() else top.parent)
        if not part:
            raise GradingError(
                f"{path}: neither a server nor a bridge: it contains no ActionServer, no action client and no "
                "/move_base_simple/goal"
            )
        scripts.append(Script(part, path, NODE_NAMES[part], [], _next_step(path, path.name)))
    return Submission(
        top.stem if top.is_file() else top.name,
        [top, _lab_folder(state)],  # `top` may contain helper modules
        lab_environment(share, state),
        scripts,
        notes=[note for script in scripts for note in _advice(script)],
    )


def _part_of(path: Path, top: Path) -> str:
    """ "server", "bridge", or "" for a file in `top` that is neither."""
    text = read_text(path, top)
    if path.name in PARTS:
        return PARTS[path.name]
    words = _names_in(text)
    if words & SERVERS:
        return "server"
    return "bridge" if words & CLIENTS or any(CLICKS in word for word in words) else ""


def _names_in(code: str) -> Set[str]:
    """Names and strings of a program, without its comments; up to the first syntax error, if there is one."""
    names: Set[str] = set()
    with contextlib.suppress(tokenize.TokenError, SyntaxError):
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            if token.type in (tokenize.NAME, tokenize.STRING):
                names.add(token.string)
    return names


def _lab_folder(state: Path) -> Path:
    return state / "grade" / "lab"


def lab_environment(share: Path, state: Path) -> Environment:
    """The environment with the lab's action and nothing written by anybody else; built once."""
    folder, underlay = _lab_folder(state), compat_environment(share, state)

    def build_lab() -> Environment:
        with tempfile.TemporaryDirectory() as source:
            make(share, Path(source, LAB))
            return workspace.build({LAB: Path(source, LAB)}, folder, underlay)

    return workspace.build_once(folder, workspace.checksums(share / "skeleton", share / "compat"), underlay, build_lab)


def _package(package: Package, share: Path, state: Path, builds: Path, sandbox: Optional[Sandbox]) -> Submission:
    folder = builds / f"{package.path.name}-{zlib.crc32(os.fsencode(package.path)):08x}"
    below = [] if package.name == LAB else [_lab_folder(state)]
    underlay = lab_environment(share, state) if below else compat_environment(share, state)
    environment = build(package.name, package.path, folder, underlay, below, sandbox)
    copy = folder / "src" / package.name
    launch_nodes = _launch_nodes(copy, folder)
    scripts: Dict[str, Script] = {}
    for path in tree.find(copy, "*.py"):
        part = _part_of(path, folder) if path.name in {*PARTS, *launch_nodes} else ""
        if part and part not in scripts:
            attributes = launch_nodes.get(path.name, {})
            arguments = attributes.get("args", "")
            scripts[part] = Script(
                part,
                path,
                attributes.get("name", NODE_NAMES[part]),
                arguments.split() if "$(" not in arguments else [],
                _next_step(path, str(path.relative_to(copy))),
            )
    if not scripts:
        raise GradingError(f"{package.path}: nothing to grade: expected scripts called {' or '.join(PARTS)}")
    return Submission(
        package.path.name,
        [folder, *below],
        environment,
        list(scripts.values()),
        _parameters(package, copy, environment, runner_in(sandbox, folder, below, LAUNCH_TIME)),
        notes=[note for script in scripts.values() for note in (*_obstacles_to_starting(script), *_advice(script))],
    )


def _next_step(path: Path, name: str) -> str:
    todo = next_todo(read_text(path))
    return f"{todo} in {name}" if todo else ""


def _advice(script: Script) -> List[str]:
    return [f"{script.part}: {script.path.name}, {text}" for text in advice(read_text(script.path))]


def _obstacles_to_starting(script: Script) -> Iterator[str]:
    """Why roslaunch could not start a script that is started here by its interpreter."""
    name = script.path.name
    if not os.access(script.path, os.X_OK):
        yield f"{script.part}: {name} is not executable, so roslaunch can't start it in the lab: chmod +x {name}"
    if read_bytes(script.path).partition(b"\n")[0].endswith(b"\r"):
        yield f"{script.part}: {name} has Windows line endings (CRLF), so roslaunch can't start it in the lab"


def _launch_nodes(copy: Path, folder: Path) -> Dict[str, Dict[str, str]]:
    """Script -> attributes of its <node> in the package's launch files, which have to be inside of `folder`."""
    nodes: Dict[str, Dict[str, str]] = {}
    for path in tree.find(copy, "*.launch"):
        for node in read_xml(path, folder).iter("node"):
            nodes.setdefault(node.get("type", ""), dict(node.attrib))
    return nodes


class _PlainLoader(yaml.SafeLoader):  # type: ignore[misc]  # PyYAML has no types
    """YAML without aliases: a few lines with them can expand to more than fits into memory."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise GradingError("its parameters refer to one another (YAML aliases), which is not supported")
        return super().compose_node(parent, index)


def _parameters(package: Package, copy: Path, environment: Environment, run: workspace.Run) -> Mapping[str, Any]:
    """The parameters that its launch file sets; launch files can run commands, so it is read in the sandbox."""
    if package.launch_file is None:
        return {}
    path = copy / package.launch_file.relative_to(package.path)
    # The system's, even if the package has a program of this name, which its environment would find first.
    program = shutil.which("roslaunch") or "roslaunch"
    command = [program, "--dump-params", str(path)]
    status, output, errors = workspace.output_of(run, command, environment, MAX_PARAMETERS)
    if status != 0 or not output.strip():  # roslaunch exits with 0 for a file that it can't load
        line = next((line for line in errors.splitlines() if line.strip()), "no reason given")
        words = re.sub("\x1b[^m]*m", "", line)[:MOST_SHOWN]  # without colours
        raise GradingError(f"{path.name}: roslaunch can't read it: {words}")
    try:
        parameters = yaml.load(output.decode(errors="replace"), _PlainLoader) or {}
    except (yaml.YAMLError, ValueError, RecursionError) as error:  # ValueError: a date that does not exist
        raise GradingError(f"{path.name}: its parameters can't be read: {str(error)[:MOST_SHOWN]}") from error
    if not isinstance(parameters, dict):
        raise GradingError(f"{path.name}: expected parameters by name, got {str(parameters)[:MOST_SHOWN]}")
    for name, value in parameters.items():
        if not isinstance(name, str) or not _is_settable(value):
            words = str(value)[:MOST_SHOWN]
            raise GradingError(f"{path.name}: {str(name)[:MOST_SHOWN]}: {words} can't be a parameter: {TYPES}")
    return {name: value for name, value in parameters.items() if name != "/use_sim_time"}


def _is_settable(value: Any, depth: int = 0) -> bool:
    """Whether the parameter server takes a value: XML-RPC has no dates, no sets, and integers of 32 bits."""
    if isinstance(value, list):
        return depth < DEEPEST and all(_is_settable(it, depth + 1) for it in value)
    if isinstance(value, dict):
        return depth < DEEPEST and all(isinstance(k, str) and _is_settable(v, depth + 1) for k, v in value.items())
    if isinstance(value, int):  # includes bool
        return -(2**31) <= value < 2**31
    return isinstance(value, (float, str))


def main() -> None:
    """Build what the first grading would build: the lab's action and compat/. Exit status 1 if that fails."""
    try:
        state, share = places()
        lab_environment(share, state)
    except RobocopError as error:
        sys.exit(f"robocop setup: {error}")


if __name__ == "__main__":
    main()
