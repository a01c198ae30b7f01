"""A folder -> the scripts of the lab's server and bridge in it, the scripts that roslaunch would start."""

import codecs
import contextlib
import io
import os
import re
import tokenize
from dataclasses import dataclass
from pathlib import Path
from typing import Collection, Dict, Iterator, List, Optional, Sequence, Set, Tuple

from aro_robocop_goto_as.names import BRIDGE, SERVER

from . import tree
from .errors import HostingError
from .launch_file import LaunchNode
from .tree import read_bytes

PARTS = {"robocop_goto_as.py": "server", "robocop_rviz_goto_ac.py": "bridge"}  # the handout's scripts
NODE_NAMES = {"server": SERVER, "bridge": BRIDGE}
SERVERS, CLIENTS = {"SimpleActionServer", "ActionServer"}, {"SimpleActionClient", "ActionClient"}
RAW = {"GoToPositionActionGoal", "GoToPositionActionResult"}  # what a server without actionlib uses
CLICK_WORD = "move_base_simple"
HINTS = (b"ActionServer", b"ActionClient", b"GoToPositionAction", CLICK_WORD.encode())
# In a path: a copy, or something that is not meant to be started.
ASIDE = re.compile(r"(^|[^a-z])(backups?|bak|old|orig|copy|copies|archive|trash|tests?)([^a-z]|$)", re.I)
# After #!: env takes the rest of the line as one word, except after -S.
PYTHON3 = re.compile(r"(/usr)?/bin/(env python3|(env -S )?python3( .*)?)")
FIRST_LINE = "#!/usr/bin/env python3"
NOT_EXECUTABLE = "is not executable"
BYTE_ORDER_MARK = "begins with a byte-order mark"
MAX_LINES = 20  # from a script's top in which a #! line is looked for
IMPORT = re.compile(rb"^[ \t]*(?:from|import)[ \t]+([\w., \t]+)", re.M)
RELAY = re.compile(rb"^python_script = '([^'\n]+)'$", re.M)  # in what catkin_install_python makes


@dataclass(frozen=True)
class Choice:
    """A part's script, the launch file's node that starts it, if any, and other scripts that could be this part."""

    path: Path
    node: Optional[LaunchNode]
    is_installed: bool  # by catkin_install_python: roslaunch starts it whatever its mode and its first line are
    others: List[Path]  # except those that it imports


@dataclass(frozen=True)
class Candidate:
    """A script that could be a part's."""

    part: str
    path: Path
    node: Optional[LaunchNode]
    is_installed: bool
    imports: Set[str]  # names of modules
    doubts: Tuple[bool, ...]  # what tells against it; the first difference between two scripts counts


def part_of(path: Path, top: Path) -> str:
    """ "server", "bridge", or "" for a file in `top` that is neither."""
    return PARTS.get(path.name) or _part_by_content(read_bytes(path, top))[0] or _part_by_name(path.name)


def _part_by_name(name: str) -> str:
    """The part of which a script has the name with something added, as in robocop_goto_as_final.py, or ""."""
    return next((part for it, part in PARTS.items() if name.startswith(it[: -len(".py")]) and name.endswith(".py")), "")


def _part_by_content(content: bytes) -> Tuple[str, bool]:
    """The part of a program by its names and strings, or "", and whether this is certain.

    It is uncertain for a program that may be the client of another action.
    """
    if not any(hint in content for hint in HINTS):
        return "", False
    words = _names_in(content.decode(errors="replace"))
    has_clicks = any(CLICK_WORD in word for word in words)
    if words & SERVERS or (words >= RAW and not has_clicks and not words & CLIENTS):
        return "server", True
    return ("bridge", has_clicks) if has_clicks or words & CLIENTS else ("", False)


def listens_to_clicks(path: Path) -> bool:
    """Return whether a program names the topic of 2D Nav Goals."""
    return any(CLICK_WORD in word for word in _names_in(read_bytes(path).decode(errors="replace")))


def _names_in(code: str) -> Set[str]:
    """Names and strings of a program, without its comments; up to the first syntax error, if there is one."""
    names: Set[str] = set()
    with contextlib.suppress(tokenize.TokenError, SyntaxError):
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            if token.type in (tokenize.NAME, tokenize.STRING):
                names.add(token.string)
    return names


def files_below(top: Path) -> List[Path]:
    """Files and links below a folder, except hidden ones and those in folders of a build or of an operating system."""
    found = []
    for folder, folders, files in tree.walk(top, tree.GENERATED):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [folder / name for name in files if not name.startswith(".")]
    return found


def doubts_of_place(path: Path, top: Path, folder: str) -> Tuple[bool, bool, bool]:
    """Whether a file is in a copy, is not executable, is not in a folder of this name: smallest for the likeliest."""
    is_aside = ASIDE.search(str(path.relative_to(top))) is not None
    return is_aside, not os.access(path, os.X_OK), path.parent.name != folder


def choose(
    top: Path, nodes: Sequence[LaunchNode] = (), relays: Collection[Path] = (), expects_one: bool = True
) -> Dict[str, Choice]:
    """The script of each part in `top`.

    The script is the one that a launch file's node in `nodes` starts, or the one with the handout's name, or the only
    one that offers the action or listens to clicks; a copy or test only if there is nothing else.

    `relays`: programs that the build has made, among them those of catkin_install_python. HostingError if two different
    scripts are equally likely, unless not `expects_one`.
    """
    found = sorted(candidates(top, nodes, relays), key=lambda it: (it.doubts, it.path))
    chosen = {}
    for part in PARTS.values():
        own = [it for it in found if it.part == part]
        if own:
            best = own[0]
            equal = [it for it in own if it.doubts == best.doubts and read_bytes(it.path) != read_bytes(best.path)]
            if equal and expects_one:
                names = " and ".join(str(it.path.relative_to(top)) for it in [best, *equal])
                raise HostingError(
                    f"{names}: each of them could be the {part}, and nothing says which one is started: "
                    "name one in the launch file, or remove the other"
                )
            others = [it.path for it in own[1:] if it.path.stem not in best.imports]
            chosen[part] = Choice(best.path, best.node, best.is_installed, others)
    return chosen


def _relayed(programs: Collection[Path]) -> Iterator[bytes]:
    """The scripts that programs made by catkin_install_python start; other programs may be of any kind and size."""
    for path in programs:
        with contextlib.suppress(HostingError):
            yield from (os.path.realpath(found[1]) for found in RELAY.finditer(read_bytes(path)))


def candidates(top: Path, nodes: Sequence[LaunchNode] = (), relays: Collection[Path] = ()) -> Iterator[Candidate]:
    """The scripts in `top` that could be a part's, as in choose()."""
    installed = set(_relayed(relays))
    launched = {started.type: started for started in reversed(nodes)}  # the first of each type
    contents = dict(_programs(top, {*PARTS, *launched}))
    parts = {path: _part_by_content(content) for path, content in contents.items()}
    for path, content in contents.items():
        node, imports = launched.get(path.name), _imports(content)
        modules = [found for other, found in parts.items() if found[0] and other != path and other.stem in imports]
        own = (PARTS[path.name], True) if path.name in PARTS else parts[path]
        part, is_sure = own if own[0] else max(modules, default=own)
        if not part:
            part, is_sure = _part_by_name(path.name), True
        if part and (is_sure or node is not None):
            is_aside, is_module = bool(ASIDE.search(str(path.relative_to(top)))), b"init_node" not in content
            doubts = node is None, is_aside, path.name not in PARTS, is_module, not is_sure
            is_installed = os.path.realpath(os.fsencode(path)) in installed
            yield Candidate(part, path, node, is_installed, imports, doubts)


def _programs(top: Path, names: Collection[str]) -> Iterator[Tuple[Path, bytes]]:
    """Python files and files of these names, with their content; HostingError if a named file can't be read."""
    for path in files_below(top):
        if path.name in names or path.suffix == ".py":
            try:
                yield path, read_bytes(path, top)
            except HostingError:
                if path.name in names:
                    raise


def _imports(content: bytes) -> Set[str]:
    """The names in a program's import statements."""
    return {name for line in IMPORT.findall(content) for name in re.findall(r"\w+", line.decode())}


def start_problems(path: Path) -> Iterator[Tuple[str, str]]:
    """Why Linux can't start a script, each with its remedy."""
    content = read_bytes(path)
    first, _, rest = content.partition(b"\n")
    if not os.access(path, os.X_OK):
        yield NOT_EXECUTABLE, f"chmod +x {path.name}"
    if first.startswith(b"#!"):
        if first.endswith(b"\r"):
            yield "has Windows line endings (CRLF)", "save it with those of Unix"
    elif content.startswith(codecs.BOM_UTF8):
        yield BYTE_ORDER_MARK, "save it as UTF-8 without one"
    elif any(line.startswith(b"#!") for line in rest.split(b"\n", MAX_LINES)):
        yield "has its #! line below other lines", "make it the first line"
    else:
        yield "has no #! line", f"make {FIRST_LINE} its first line"


def interpreter(path: Path) -> str:
    """What a script's first line names instead of python3; empty if it names nothing else."""
    first = read_bytes(path).partition(b"\n")[0].decode(errors="replace")
    words = " ".join(first[2:].split())
    return words if first.startswith("#!") and not PYTHON3.fullmatch(words) else ""
