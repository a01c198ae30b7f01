"""A path -> what of the lab is there, built, with the commands that start it."""

import io
import os
import re
import sys
import tempfile
import tokenize
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set

import yaml

from ..errors import GradingError
from ..hosting import workspace
from ..hosting.compat import compat_environment
from ..hosting.files import read_text, read_xml
from ..hosting.package import NODES, Package, find_package
from ..hosting.workspace import Environment, alone, sourced
from . import building
from .sandbox import Cage
from .skeleton import make

LAB = "aro_robocop_goto_as"
PARTS = dict(zip((script for script, _ in NODES), ("server", "bridge")))
SERVERS, CLIENTS = {"SimpleActionServer", "ActionServer"}, {"SimpleActionClient", "ActionClient"}
CLICKS = "move_base_simple"
LAUNCH_PATIENCE = 30.0  # [s, wall]
MOST_PARAMETERS = 100_000  # bytes of roslaunch's listing


@dataclass(frozen=True)
class Script:
    """One of the lab's two nodes."""

    part: str  # server or bridge
    path: Path
    node: str  # its name
    arguments: List[str] = field(default_factory=list)

    def command(self) -> List[str]:
        """What starts it; this interpreter, whatever its first line says, as students' Pythons differ."""
        return [sys.executable, str(self.path), *self.arguments, f"__name:={self.node}"]


@dataclass(frozen=True)
class Submission:
    """What is to be graded."""

    name: str
    path: Path
    reads: Sequence[Path]  # all that it needs to read, besides the system and what everybody's code needs
    environment: Environment
    scripts: List[Script]
    parameters: Mapping[str, Any] = field(default_factory=dict)


def take(path: str, share: Path, state: Path, workshop: Path, cage: Optional[Cage]) -> Submission:
    """The submission at `path`; a package is built, in the cage, in a folder of its own below `workshop`.

    GradingError or HostingError says why there is none.
    """
    top = Path(path).expanduser().resolve()
    if top.is_file():
        return _files([top], top, share, state)
    if not top.is_dir():
        raise GradingError(f"{path}: expected a package, a server's or a bridge's file; there is nothing")
    loose = [next(iter(sorted(top.rglob(script))), top) for script in PARTS]
    if loose != [top, top] and not list(top.rglob("package.xml")):
        return _files([path for path in loose if path != top], top, share, state)
    return _package(find_package(str(top)), share, state, workshop, cage)


def _files(paths: List[Path], top: Path, share: Path, state: Path) -> Submission:
    """Loose files in `top`, run where they are, with the skeleton's package around them."""
    scripts: List[Script] = []
    for path in paths:
        if not path.is_file() or top not in (path.resolve(), *path.resolve().parents):
            raise GradingError(f"{path}: expected a file, and no link to one elsewhere")
        part = _part_of(path)
        if not part:
            raise GradingError(
                f"{path}: neither a server nor a bridge: no ActionServer in it, and neither a client nor "
                "/move_base_simple/goal"
            )
        scripts.append(Script(part, path, dict(NODES)[_script(part)]))
    return Submission(
        top.stem if top.is_file() else top.name,
        top,
        [top, state / "grade" / "lab"],  # helper modules beside them included
        lab_environment(share, state),
        scripts,
    )


def _script(part: str) -> str:
    return next(script for script, it in PARTS.items() if it == part)


def _part_of(path: Path) -> str:
    """server, bridge, or nothing for a file that is neither."""
    if path.name in PARTS:
        return PARTS[path.name]
    words = _names_in(read_text(path))
    if words & SERVERS:
        return "server"
    return "bridge" if words & CLIENTS or any(CLICKS in word for word in words) else ""


def _names_in(code: str) -> Set[str]:
    """Names and strings of a program, without its comments; of one that is broken, whatever comes before that."""
    found: Set[str] = set()
    try:
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            if token.type in (tokenize.NAME, tokenize.STRING):
                found.add(token.string)
    except (tokenize.TokenError, SyntaxError):
        pass
    return found


def lab_environment(share: Path, state: Path) -> Environment:
    """The environment with the lab's action in it, and nothing else of anybody's; built once."""
    folder = state / "grade" / "lab"
    stamp = folder / "built-from"
    wanted = " ".join(
        f"{path.name}:{zlib.crc32(path.read_bytes()):x}"
        for name in ("skeleton", "compat")
        for path in sorted((share / name).rglob("*"))
        if path.is_file()
    )
    underlay = compat_environment(share, state)
    with alone(folder):
        if stamp.is_file() and stamp.read_text() == wanted:
            return sourced(folder / "devel" / "setup.bash", underlay)
        stamp.unlink(missing_ok=True)
        with tempfile.TemporaryDirectory() as made:
            make(share, Path(made, LAB))
            environment = workspace.build({LAB: Path(made, LAB)}, folder, underlay)
        stamp.write_text(wanted)
    return environment


def _package(package: Package, share: Path, state: Path, workshop: Path, cage: Optional[Cage]) -> Submission:
    folder = workshop / f"{package.path.name}-{zlib.crc32(os.fsencode(package.path)):08x}"
    below = [] if package.name == LAB else [state / "grade" / "lab"]
    underlay = lab_environment(share, state) if below else compat_environment(share, state)
    environment = building.build(package.name, package.path, folder, underlay, below, cage)
    copy = folder / "src" / package.name
    launched = _launched(copy)
    scripts: List[Script] = []
    for path in sorted(copy.rglob("*.py")):
        part = _part_of(path) if path.name in {*PARTS, *launched} else ""
        if part and part not in [script.part for script in scripts]:
            entry = launched.get(path.name, {})
            scripts.append(
                Script(
                    part,
                    path,
                    entry.get("name", dict(NODES)[_script(part)]),
                    entry.get("args", "").split() if "$(" not in entry.get("args", "") else [],
                )
            )
    if not scripts:
        raise GradingError(f"{package.path}: nothing to grade: expected scripts called {' or '.join(PARTS)}")
    return Submission(
        package.path.name,
        package.path,
        [folder, *below],
        environment,
        scripts,
        _parameters(package, copy, environment, building.run_in(cage, folder, below, LAUNCH_PATIENCE)),
    )


def _launched(copy: Path) -> Dict[str, Dict[str, str]]:
    """Script -> attributes of its <node> in the package's launch files."""
    found: Dict[str, Dict[str, str]] = {}
    for path in sorted(copy.rglob("*.launch")):
        for node in read_xml(path).iter("node"):
            found.setdefault(node.get("type", ""), dict(node.attrib))
    return found


class _PlainLoader(yaml.SafeLoader):
    """YAML without aliases: a few lines of them can stand for more than fits into memory."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise GradingError("its parameters refer to one another (YAML aliases), which is not supported")
        return super().compose_node(parent, index)


def _parameters(package: Package, copy: Path, environment: Environment, run: workspace.Run) -> Mapping[str, Any]:
    """What its launch file sets on the parameter server; launch files may run commands, so it is read in the cage."""
    if package.launch_file is None:
        return {}
    path = copy / package.launch_file.relative_to(package.path)
    status, output, errors = building.output_of(run, ["roslaunch", "--dump-params", str(path)], environment,
                                                MOST_PARAMETERS)
    if status != 0 or not output.strip():  # roslaunch's status is 0 for a file that it can't load
        raise GradingError(f"{path.name}: roslaunch can't read it: {_first_line(errors)}")
    try:
        found = yaml.load(output, _PlainLoader) or {}
    except yaml.YAMLError as error:
        raise GradingError(f"{path.name}: its parameters can't be read: {error}") from error
    return {name: value for name, value in found.items() if name != "/use_sim_time"}


def _first_line(text: str) -> str:
    """What roslaunch says first, without its colours."""
    return next((re.sub("\x1b[^m]*m", "", line) for line in text.splitlines() if line.strip()), "no reason given")
