"""A folder -> the scripts of the lab's server and bridge in it, the scripts that roslaunch would start."""

import codecs
import contextlib
import io
import os
import re
import tokenize
from dataclasses import dataclass
from pathlib import Path
from typing import Collection, Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from aro_robocop_goto_as.names import BRIDGE, SERVER

from . import tree
from .errors import HostingError
from .launch_file import LaunchNode
from .tree import read_bytes

PART_OF = {"robocop_goto_as.py": "server", "robocop_rviz_goto_ac.py": "bridge"}  # the handout's scripts
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
HAS_BYTE_ORDER_MARK = "begins with a byte-order mark"
IMPORT = re.compile(rb"^[ \t]*(?:from|import)[ \t]+([\w., \t]+)", re.M)


@dataclass(frozen=True)
class Choice:
    """A part's script, the launch file's node that starts it, if any, and other scripts that could be this part."""

    path: Path
    node: Optional[LaunchNode]
    is_installed: bool  # under its name, by catkin_install_python: roslaunch starts it whatever its mode and first line
    others: List[Path]  # except those that it imports


class Candidate(NamedTuple):
    """A script that could be a part's; the likeliest is the smallest."""

    doubts: Tuple[bool, ...]  # what tells against it; the first difference between two scripts counts
    path: Path
    part: str
    node: Optional[LaunchNode]


def part_of(path: Path) -> str:
    """ "server", "bridge", or "" for a file that is neither; any action client is a bridge here."""
    return PART_OF.get(path.name) or _part_by_words(_words(read_bytes(path)), CLIENTS) or _part_by_name(path.name)


def _part_by_name(name: str) -> str:
    """The part whose script has this name, or one with something added, as in robocop_goto_as_final.py, or ""."""
    return next((part for it, part in PART_OF.items() if name.startswith(it[:-3]) and name.endswith(".py")), "")


def _part_by_words(words: Set[str], of_bridge: Collection[str] = ()) -> str:
    """The part of a program with these names and strings, or ""; `of_bridge`: words that only a bridge has."""
    has_clicks = any(CLICK_WORD in word for word in words)
    if words & SERVERS or (words >= RAW and not has_clicks and not words & CLIENTS):
        return "server"
    return "bridge" if has_clicks or words.intersection(of_bridge) else ""


def _words(content: bytes) -> Set[str]:
    """Names and strings of a program that may be a part, without its comments; up to the first syntax error."""
    names: Set[str] = set()
    if any(hint in content for hint in HINTS):
        with contextlib.suppress(tokenize.TokenError, SyntaxError):
            for token in tokenize.generate_tokens(io.StringIO(content.decode(errors="replace")).readline):
                if token.type in (tokenize.NAME, tokenize.STRING):
                    names.add(token.string)
    return names


def listens_to_clicks(path: Path) -> bool:
    """Return whether a program names the topic of 2D Nav Goals."""
    return any(CLICK_WORD in word for word in _words(read_bytes(path)))


def files_below(top: Path) -> List[Path]:
    """Files and links below a folder, except hidden ones and those in folders of a build or of an operating system."""
    found = []
    for folder, folders, files in tree.walk(top, tree.GENERATED):
        folders[:] = [name for name in folders if not name.startswith(".")]
        found += [folder / name for name in files if not name.startswith(".")]
    return found


def choose(
    top: Path, nodes: Sequence[LaunchNode] = (), relays: Collection[Path] = (), expects_one: bool = True
) -> Dict[str, Choice]:
    """The script of each part in `top`.

    The script is the one that a launch file's node in `nodes` starts, or the one with the handout's name, or the only
    one that offers the action or listens to clicks; a copy or test only if there is nothing else.

    `relays`: programs that the build has made, among them those of catkin_install_python. HostingError if two different
    scripts are equally likely, unless not `expects_one`.
    """
    found, chosen = sorted(candidates(top, nodes)), {}
    for part in PART_OF.values():
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
            imports, is_installed = _imports(read_bytes(best.path)), best.path.name in {it.name for it in relays}
            others = [it.path for it in own[1:] if it.path.stem not in imports]
            chosen[part] = Choice(best.path, best.node, is_installed, others)
    return chosen


def candidates(top: Path, nodes: Sequence[LaunchNode] = ()) -> Iterator[Candidate]:
    """The scripts in `top` that could be a part's, as in choose()."""
    launched = {started.type: started for started in reversed(nodes)}  # the first of each type
    contents = dict(_programs(top, {*PART_OF, *launched}))
    words = {path: _words(content) for path, content in contents.items()}
    parts = {path: _part_by_words(it) for path, it in words.items()}  # a client may be that of another action
    for path, content in contents.items():
        node, imports = launched.get(path.name), _imports(content)
        modules = [part for other, part in parts.items() if other != path and other.stem in imports]
        part = PART_OF.get(path.name) or parts[path] or max(modules, default="")
        if not part and words[path] & CLIENTS:
            part = "bridge" if node else ""
        elif not part:
            part = _part_by_name(path.name)
        if part:
            is_aside = bool(ASIDE.search(str(path.relative_to(top))))
            doubts = node is None, is_aside, path.name not in PART_OF, b"init_node" not in content, not parts[path]
            yield Candidate(doubts, path, part, node)


def _programs(top: Path, names: Collection[str]) -> Iterator[Tuple[Path, bytes]]:
    """Python files and files of these names, with their content; HostingError if a named file can't be read."""
    for path in files_below(top):
        if path.name in names or path.suffix == ".py":
            try:
                yield path, read_bytes(path)
            except HostingError:
                if path.name in names:
                    raise


def _imports(content: bytes) -> Set[str]:
    """The names in a program's import statements."""
    return {name for line in IMPORT.findall(content) for name in re.findall(r"\w+", line.decode())}


def start_problems(path: Path) -> Iterator[Tuple[str, str]]:
    """Why Linux can't start a script, each with its remedy."""
    content = read_bytes(path)
    first = content.partition(b"\n")[0]
    if not os.access(path, os.X_OK):
        yield NOT_EXECUTABLE, f"chmod +x {path.name}"
    if first.startswith(b"#!"):
        if first.endswith(b"\r"):
            yield "has Windows line endings (CRLF)", "save it with those of Unix"
    elif content.startswith(codecs.BOM_UTF8):
        yield HAS_BYTE_ORDER_MARK, "save it as UTF-8 without one"
    else:
        yield "does not begin with a #! line", f"make {FIRST_LINE} its first line"


def interpreter(path: Path) -> str:
    """What a script's first line names instead of python3; empty if it names nothing else."""
    first = read_bytes(path).partition(b"\n")[0].decode(errors="replace")
    words = " ".join(first[2:].split())
    return words if first.startswith("#!") and not PYTHON3.fullmatch(words) else ""
