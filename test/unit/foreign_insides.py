"""Places that use the insides of another library: what it does not document, and what is set on it from outside."""

import ast
import re
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Tuple

OWN = ("aro_robocop_goto_as", "robocop_grading")
UNDOCUMENTED = (
    *("rospy.client", "rospy.core", "rospy.impl", "rospy.msg", "rospy.names", "rospy.rostime", "rospy.timer"),
    *("rospy.topics", "rosgraph.roslogging", "rosgraph.xmlrpc", "rosmaster.master_api"),
    *("roslaunch.core", "roslaunch.loader", "roslaunch.nodeprocess", "roslaunch.parent", "roslaunch.pmon"),
    *("roslaunch.rlutil", "actionlib.action_client", "actionlib.action_server"),
)
# What ROS's wiki describes of these: rospy's overviews, and roslaunch's page "API Usage".
DOCUMENTED = (
    *("rospy.core.is_shutdown_requested", "rospy.rostime.wallsleep", "rospy.timer.TimerEvent"),
    *("roslaunch.core.Node", "roslaunch.parent", "roslaunch.pmon.ProcessListener", "roslaunch.rlutil"),
)
DOCUMENTED_ATTRIBUTES = {"_exit", "_fields", "_replace", "_connection_header", "_md5sum", "_type"}
# Undocumented attributes of rospy.Publisher, actionlib.ActionServer, ActionClient and SimpleActionServer.
ATTRIBUTES = {
    *("impl", "action_server", "current_goal", "next_goal", "last_cancel", "last_status_msg", "internal_goal_callback"),
    *("goal_sub", "cancel_sub", "status_pub", "feedback_pub", "result_pub"),
    *("pub_goal", "pub_cancel", "status_sub", "feedback_sub", "result_sub"),
}
HAVE_HOOKS = ("os", "sys", "tempfile", "threading")  # whose attributes are meant to be set


class Place(NamedTuple):
    """A line, and what it uses."""

    line: int
    what: str


def places(path: Path) -> List[Place]:
    """The places in a module, each line once."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = dict(_imported(tree))
    found = [place for node in ast.walk(tree) for place in _of(node, imported)]
    return sorted({place.line: place for place in found}.values())


def _imported(tree: ast.AST) -> Iterator[Tuple[str, str]]:
    """Local names of other libraries' modules, functions and classes, with their full names."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                top = alias.name.partition(".")[0]
                if top not in OWN:
                    yield (alias.asname, alias.name) if alias.asname else (top, top)
        elif isinstance(node, ast.ImportFrom) and not node.level and str(node.module).partition(".")[0] not in OWN:
            for alias in node.names:
                yield alias.asname or alias.name, f"{node.module}.{alias.name}"


def _of(node: ast.AST, imported: Dict[str, str]) -> Iterator[Place]:
    """What one node of a syntax tree uses, without the nodes inside of it."""
    if isinstance(node, ast.ImportFrom) and not node.level:
        names = [f"{node.module}.{alias.name}" for alias in node.names]
        yield from (Place(node.lineno, f"imports {name}") for name in names if _is_undocumented(name))
    elif isinstance(node, ast.Attribute):
        name = _full_name(node, imported)
        if _is_undocumented(name):
            yield Place(node.lineno, f"uses {name}")
        elif _is_private(node):
            yield Place(node.lineno, f"uses {ast.unparse(node)}")
        elif isinstance(node.ctx, ast.Store) and _is_foreign(name):
            yield Place(node.lineno, f"sets {name}")
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setattr":
        name = _full_name(node.args[0], imported)
        if _is_foreign(name):
            yield Place(node.lineno, f"setattr on {name}")
    elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
        text = ast.unparse(node.value)
        if text == "sys.modules" or text.startswith("vars("):
            yield Place(node.lineno, f"sets {ast.unparse(node)}")


def _full_name(node: ast.AST, imported: Dict[str, str]) -> str:
    """The name of what is reached through an import, such as rospy.core.is_shutdown; empty for anything else."""
    if isinstance(node, ast.Attribute):
        of = _full_name(node.value, imported)
        return of and f"{of}.{node.attr}"
    return imported.get(node.id, "") if isinstance(node, ast.Name) else ""


def _is_foreign(name: str) -> bool:
    return bool(name) and name.partition(".")[0] not in HAVE_HOOKS


def _is_undocumented(name: str) -> bool:
    """Whether a name is in an undocumented module; the module alone is not, as it may lead to a documented name."""
    within = any(name.startswith(f"{module}.") for module in UNDOCUMENTED)
    return within and not any(f"{name}.".startswith(f"{documented}.") for documented in DOCUMENTED)


def _is_private(node: ast.Attribute) -> bool:
    """Whether an attribute is private by its underscore or by ATTRIBUTES, and not one of the object's own class."""
    own = ast.unparse(node.value) in ("self", "cls", "super()")
    private = node.attr in ATTRIBUTES or re.match("_[a-z]", node.attr) and node.attr not in DOCUMENTED_ATTRIBUTES
    return bool(private) and not own
