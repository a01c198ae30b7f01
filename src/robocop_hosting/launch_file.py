"""A launch file -> the nodes and parameters that roslaunch would start and set."""

import json
import os
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Sequence

from .errors import HostingError
from .workspace import Environment, output_of

READER = Path(__file__).resolve().with_name("roslaunch_reader.py")
MAX_SHOWN = 200  # characters of an error in a message
VARIABLE = re.compile(r"[A-Za-z_]\w*")
WHILE = re.compile(r"while processing (.*):\n")  # an included file


@dataclass(frozen=True)
class LaunchNode:
    """A <node> with all that roslaunch has resolved: arguments, namespaces, remappings, conditions, includes."""

    package: str
    type: str
    name: str
    location: str  # file and line
    namespace: str = "/"
    arguments: List[str] = field(default_factory=list)  # remappings included
    environment: Mapping[str, str] = field(default_factory=dict)
    not_done: List[str] = field(default_factory=list)  # attributes that have no effect in a grading
    is_own: bool = True  # in a file of the package, not in one that it includes from another one

    @property
    def variables(self) -> Environment:
        """The environment variables that roslaunch sets for the node."""
        namespace = self.namespace.rstrip("/")
        return {**self.environment, **({"ROS_NAMESPACE": namespace} if namespace else {})}


@dataclass(frozen=True)
class LaunchFile:
    """What a launch file starts and sets."""

    nodes: List[LaunchNode]
    parameters: Mapping[str, Any]
    warnings: List[str]  # of roslaunch


def read(path: Path, top: Path, environment: Environment, arguments: Sequence[str] = ()) -> LaunchFile:
    """What roslaunch makes of a launch file of the package at `top`.

    `arguments`: NAME:=VALUE. HostingError with roslaunch's reason and the line if it can't be loaded.
    """
    name = str(path.relative_to(top))
    command = [sys.executable, str(READER), str(path), *arguments]
    status, output, errors = output_of(command, environment)
    if status != 0:
        raise HostingError(f"{name}: roslaunch can't read it: {_last_line(errors)}")
    values = json.loads(output)
    if "error" in values:
        raise HostingError(_failure(values, name, top))
    nodes = [_node(entry, top) for entry in values["nodes"]]
    parameters = {key: value for key, value in values["parameters"].items() if key != "/use_sim_time"}
    return LaunchFile(nodes, parameters, [f"{name}: {it}" for it in values["warnings"]])


def _last_line(errors: str) -> str:
    lines = [line for line in re.sub("\x1b[^m]*m", "", errors).splitlines() if line.strip()]  # without colours
    return (lines or ["no reason given"])[-1][:MAX_SHOWN]


def _failure(values: Mapping[str, Any], name: str, top: Path) -> str:
    """Why roslaunch can't load the file, with the place, which may be in an included file."""
    words, place = str(values["error"]), _location(str(values["file"] or name), int(values["line"]), top)
    included = WHILE.findall(words)
    reason = " ".join(
        re.split(r"\n\s*\w+ xml is|\nXML is|\. Node xml is|\n *ROS path", WHILE.sub("", words))[0].split()
    )
    reason = re.sub(r"^(XmlParse|Load)?Exception: ", "", reason)
    reason = re.sub(r"^ResourceNotFound: (\S+)$", r"package \1 not found", reason)
    within = f" (in {_location(included[-1], 0, top)})" if included else ""
    return f"{place}: roslaunch can't read it: {reason[:MAX_SHOWN]}{within}"


def _location(file: str, line: int, top: Path) -> str:
    path = Path(os.path.realpath(file))
    shown = path.relative_to(top) if top in path.parents else path
    return f"{shown}, line {line}" if line else str(shown)


def _node(values: Dict[str, Any], top: Path) -> LaunchNode:
    file, line = values.pop("file"), values.pop("line")
    node = LaunchNode(location=_location(file, line, top), is_own=top in Path(os.path.realpath(file)).parents, **values)
    for variable, value in node.environment.items():
        if not VARIABLE.fullmatch(variable) or "\0" in value:
            raise HostingError(f"{node.location}: <env name={variable[:MAX_SHOWN]!r}>: expected the name of a variable")
    return node
