"""Advice on a submission's source code: mistakes that cost no points, but sometimes fail on a robot or simulator."""

import ast
from typing import Dict, Iterator, List, Mapping, Tuple

AUTO_START = (
    "SimpleActionServer starts before the constructor has finished, so a goal may find attributes missing: pass "
    "auto_start=False, and call start() as the constructor's last step"
)
WALL_SLEEP = (
    "time.sleep follows the wall clock, not the simulator's, so the loop's rate depends on how fast simulated time "
    "passes: use rospy.Rate or rospy.sleep"
)
WALL_ALARM = (
    "signal.alarm and signal.setitimer follow the wall clock, also in the grader, where simulated time passes at "
    "another rate: use rospy.Timer"
)


def advice(code: str) -> List[str]:
    """The advice about a program, each piece once with its first line; none for a program that is not Python 3."""
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    first: Dict[str, int] = {}
    imported: Dict[str, Tuple[str, str]] = {}  # module and name of what `from MODULE import NAME` imports
    for node in ast.walk(tree):  # outermost first, so an import comes before its calls
        if isinstance(node, ast.ImportFrom):
            imported.update({it.asname or it.name: (node.module or "", it.name) for it in node.names})
        elif isinstance(node, ast.Call):
            for text in _about(node, imported):
                first[text] = min(node.lineno, first.get(text, node.lineno))
    return [f"line {line}: {text}" for text, line in sorted(first.items(), key=lambda entry: entry[1])]


def _about(call: ast.Call, imported: Mapping[str, Tuple[str, str]]) -> Iterator[str]:
    of, name = "", ""
    if isinstance(call.func, ast.Name):
        of, name = imported.get(call.func.id, ("", call.func.id))
    elif isinstance(call.func, ast.Attribute):
        of, name = call.func.value.id if isinstance(call.func.value, ast.Name) else "", call.func.attr
    if name == "SimpleActionServer":
        # name, ActionSpec, execute_cb, auto_start
        given = [keyword.value for keyword in call.keywords if keyword.arg == "auto_start"] or call.args[3:4]
        unknown = any(keyword.arg is None for keyword in call.keywords)  # **options
        if not unknown and all(isinstance(value, ast.Constant) and value.value is True for value in given):
            yield AUTO_START  # also without the argument: True is its default
    elif (of, name) == ("time", "sleep"):
        yield WALL_SLEEP
    elif (of, name) in (("signal", "alarm"), ("signal", "setitimer"), ("", "setitimer")):
        yield WALL_ALARM
