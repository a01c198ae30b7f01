"""Usage: python3 roslaunch_reader.py FILE [NAME:=VALUE...]: what roslaunch's loader makes of a launch file, as JSON.

It is a separate program, because launch files can run commands. It imports nothing of the grader.
"""

import json
import reprlib
import shlex
import sys
import traceback
import xmlrpc.client
from typing import Any, Dict, Iterator, List, Optional, Tuple
from xml.parsers import expat

del sys.path[0]  # the grader's modules: not to be found in place of others

from roslaunch.config import ROSLaunchConfig  # noqa: E402
from roslaunch.core import Node  # noqa: E402
from roslaunch.xmlloader import XmlLoader  # noqa: E402

MAX_SHOWN = 100  # characters of a parameter in a message
Tags = List[Tuple[str, Dict[str, str], int]]  # name, attributes, line


def tags(path: str) -> Tags:
    """All start tags of a file in their order."""
    found: Tags = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, attributes: found.append((name, attributes, parser.CurrentLineNumber))
    with open(path, "rb") as file:
        parser.ParseFile(file)
    return found


def line_of_node(node: Node) -> int:
    """The line of a node's tag; 0 if its name and type come from arguments."""
    own = [(attributes, line) for name, attributes, line in tags(node.filename) if name == "node"]
    for attribute, value in (("name", node.name), ("type", node.type)):
        for attributes, line in own:
            if attributes.get(attribute) == value:
                return line
    return 0


def place_of(error: Optional[BaseException]) -> Tuple[str, int]:
    """File and line of the tag that the loader had reached; ("", 0) if it had not reached any."""
    reached: Optional[Tuple[Any, str]] = None
    while error is not None:
        for frame, _ in traceback.walk_tb(error.__traceback__):
            if {"tag", "context"}.issubset(frame.f_code.co_varnames):
                reached = frame.f_locals["tag"], frame.f_locals["context"].filename
        error = error.__context__
    if reached is None:
        return "", 0
    tag, path = reached
    position = tag.ownerDocument.getElementsByTagName(tag.tagName).index(tag)
    return path, [line for name, _, line in tags(path) if name == tag.tagName][position]


def not_done(node: Node) -> Iterator[str]:
    """What roslaunch would do for a node, but the grader does not."""
    if node.launch_prefix:
        yield f"launch-prefix={node.launch_prefix!r}"
    if node.machine_name:
        yield f"machine={node.machine_name!r}"
    if node.cwd == "node":
        yield "cwd='node'"
    if node.respawn:
        yield "respawn='true'"


def as_values(node: Node) -> Dict[str, Any]:
    """A node as plain values."""
    return {
        "package": node.package,
        "type": node.type,
        "name": node.name,
        "namespace": node.namespace,
        "arguments": [*shlex.split(node.args), *(f"{old}:={new}" for old, new in node.remap_args)],
        "environment": {str(name): str(value) for name, value in node.env_args},
        "not_done": list(not_done(node)),
        "file": node.filename,
        "line": line_of_node(node),
    }


def read(path: str, arguments: List[str]) -> Dict[str, Any]:
    """Nodes and parameters, or an error with its file and line."""
    config, loader = ROSLaunchConfig(), XmlLoader()
    loader.ignore_unset_args = False
    try:
        loader.load(path, config, argv=arguments, verbose=False)
    except Exception as error:  # the loader documents no list of what it raises
        file, line = place_of(error)
        return {"error": f"{type(error).__name__}: {error}", "file": file, "line": line}
    nodes = []
    for node in config.nodes:
        try:
            nodes.append(as_values(node))
        except ValueError as error:  # of shlex
            return {"error": f"args={node.args!r}: {error}", "file": node.filename, "line": line_of_node(node)}
    parameters = {str(name): parameter.value for name, parameter in config.params.items()}
    for name, value in parameters.items():
        try:
            xmlrpc.client.dumps((value,))  # as the parameter server gets it
            json.dumps(value)
        except (TypeError, ValueError, OverflowError, RecursionError) as error:
            shown = (reprlib.repr(value) if isinstance(value, (dict, list)) else str(value))[:MAX_SHOWN]
            return {"error": f"{name}: {shown} can't be a parameter: {error}", "file": path, "line": 0}
    return {"nodes": nodes, "parameters": parameters, "warnings": list(map(str, config.config_errors))}


if __name__ == "__main__":
    print(json.dumps(read(sys.argv[1], sys.argv[2:])))
