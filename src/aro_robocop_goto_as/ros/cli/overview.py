"""What ./robocop run prints when everything runs: the world, the robots, what to do next."""

import os
import re
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple

import rosgraph

from ...names import COMMAND_VARIABLE, SERVER, WEB, robocop
from ...param_loading import from_dict
from ...simulation.params import SimParams
from ...web.access import default_host, is_loopback, url
from ...web.params import WebParams

DEFAULT_MASTER = "http://localhost:11311"  # roscore's port
DEFAULT_WORLD = SimParams().world.world
# Goals in this world, after a reset: in front of the robot, and one that no moving pillar comes near to
IN_FRONT, BESIDE = "0.3 0", "-0.7 -0.6"
WITH_PILLARS = ("stage_3", "stage_4")  # that moving:=true moves
REPLAYED = "replay:="  # an argument of the web page


def overview(running: Sequence[Any], simulator: Optional[Dict[str, Any]], logs: Path, messages_shown: bool) -> str:
    """The text for the nodes of a roslaunch configuration and the parameters of the simulator, if there is one.

    The nodes' messages are shown on the screen or go to files in `logs`.
    """
    nodes = {node.name for node in running}
    given = simulator or {}
    rows = [] if simulator is None else [*_simulated(given)]
    served = [node.namespace.strip("/") for node in running if node.name == SERVER]  # robots; RViz shows the first
    command = _command()
    for node in running:
        if is_page(node):
            waits = "; it plays when the page is opened" if REPLAYED in node.args and "rviz" not in nodes else ""
            rows.append(("view", f"in a browser: {_page(node.args)}{waits}"))
    if served:
        ways = []
        if "rviz" in nodes:
            ways.append("in RViz: press 2D Nav Goal (or G), then click and drag")
        if WEB in nodes:
            ways.append("in the browser: click on the floor")
        robot = f" --robot {served[0]}" if served[0] else ""
        goal, note = BESIDE if given.get("moving") else IN_FRONT, ""
        if given.get("world", DEFAULT_WORLD) != DEFAULT_WORLD:
            goal, note = "X Y", "   (X and Y in map, in metres)"
        ways.append(f"in a second terminal: {command} goto {goal}{robot}{note}")
        rows += zip(("send a goal", "", ""), ways)
    in_files = f"{logs} (or start with --verbose); warnings and errors appear below"
    rows += [
        ("inspect", f"in a second terminal: {command} shell, then rostopic list, rosnode list, ..."),
        *_hosted(),
        ("stop", "Ctrl-C in this terminal" + (", or close RViz" if "rviz" in nodes else "")),
        ("all messages", "appear below" if messages_shown else in_files),
    ]
    return "\n".join(f"{name:14}{text}" for name, text in rows) + "\n"


def _command() -> str:
    """The command line of ./robocop in a second terminal, which may not know this one's master."""
    uri, command = rosgraph.get_master_uri(), robocop()
    is_default = uri.rstrip("/") == DEFAULT_MASTER
    is_known = is_default or COMMAND_VARIABLE in os.environ  # a container has one environment
    return command if is_known else f"ROS_MASTER_URI={uri} {command}"


def _hosted() -> List[Tuple[str, str]]:
    """What makes a shell of ./robocop know the messages and programs of a hosted package, if there is one."""
    devel = os.environ.get("CMAKE_PREFIX_PATH", "").partition(":")[0]
    if devel == os.environ.get("ROBOCOP_WS", devel):
        return []
    return [("", f"for the package's own messages and nodes, type there: source {devel}/setup.bash --extend")]


def is_page(node: Any) -> bool:
    """Return whether a node is the web page, also one that plays a recording."""
    return node.name == WEB or REPLAYED in node.args


def _page(arguments: str) -> str:
    """The web page's address, from the arguments of its node; one that only this machine reaches says so."""
    given = dict(re.findall(r"\b(web_host|web_port):=(\S+)", arguments))
    host = given.get("web_host") or default_host()
    address = url(host, given.get("web_port", WebParams.web_port))
    return f"{address} (from a phone with web_host:=0.0.0.0)" if is_loopback(host) else address


def _simulated(given: Dict[str, Any]) -> List[Tuple[str, str]]:
    """World, robots, and whether transforms are lacking."""
    p = from_dict(SimParams, given, "the simulator's parameters")
    world = p.world.world
    if p.world.moving:
        world += ", moving:=true; obstacles may move into the robot's way, moving:=false stops them"
    elif world in WITH_PILLARS:
        world += "; its pillars stand still, moving:=true starts them"
    robots, model = p.robots.robots.strip("; "), p.robots.model
    shown = f"{robots} ({model} unless named)" if robots else model
    rows = [("world", world), ("robots" if robots else "robot", shown)]
    without = "none from odom to the robot: a bridge that transforms goals needs odom_tf:=true"
    return rows if p.topics.odom_tf else [*rows, ("transforms", without)]
