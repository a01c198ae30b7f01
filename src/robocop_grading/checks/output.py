"""Reads the node's output and log: complaints of actionlib, exceptions, the last error."""

import math
import os
import re
from typing import Iterator, Pattern, Sequence

from ..record import Record
from ..texts import sentences

# How a line at a level begins: as the recording writes /rosout, or as rospy writes it to a terminal.
_WARNING = r"^(?:\x1b\[[\d;]*m)*\[ *(?:WARN|WARNING|ERROR)\] ?(?:\[[\d., ]+\]:? ?)?"
_ERROR = _WARNING.replace("WARN|WARNING|ERROR", "ERROR")
PROBLEM = re.compile(_WARNING.replace("ERROR", "ERROR|FATAL"))
# actionlib's messages (server_goal_handle.py, simple_action_server.py), in Python and C++, at their levels.
TWO_STATES_LOGGED = re.compile(
    _ERROR
    + r"To transition to an? (?:active|rejected|canceled|cancelled|aborted|succeeded) state, the goal must be in an? "
    + r"[a-z, ]+ state, it is currently in state: (\d+)"
)
NO_STATE_LOGGED = re.compile(_WARNING + r"Your executeCallback did not set the goal to a terminal status\.")
EXECUTE_RAISED = re.compile(rf"{_ERROR}Exception in your execute callback: ")
TRACEBACK_LOGGED = re.compile(rf"^(?:{_ERROR[1:]})?Traceback \(most recent call last\):")
# In the words of Python, asyncio, rospy and actionlib. A traceback alone is also that of an exception that the node has
# caught and printed, unless the node has died of it.
UNCAUGHT = re.compile(
    "^(?:Syntax|Indentation|Tab)Error|^Exception (?:in thread|in callback|ignored in:?) |^Task exception was never "
    rf"|{_ERROR}bad callback: |{EXECUTE_RAISED.pattern}"
)
PLACE = re.compile(r'File "([^"]{1,500})", line (\d+)')  # in a traceback
# The path of a file that is not the node's: of a library, or of the agent under which it runs.
LIBRARY = re.compile(r"^<|/(dist|site)-packages/|/lib/python3|/opt/ros/|/robocop_grading/agent/")
PATH_IN_ERROR = re.compile(r"(?<=in file ).*/([^/]+ on line \d)")  # in Python's words for a file that is not UTF-8
INFORMATION = re.compile(r"(\x1b\[\d*m)*\[ *(INFO|DEBUG)\b")  # as rospy begins such a line, in a terminal or a log
UNKNOWN_TYPE = re.compile("Type .{1,100} if not loaded or supported")  # in tf2's words
NOT_IMPORTED = "tf2 can transform messages of geometry_msgs only after: import tf2_geometry_msgs"
NO_STATE = "execute_cb returned without calling set_succeeded, set_aborted or set_preempted"
JUST_BEFORE = 1.0  # [s] before a goal's end, in which an exception can be its cause
DELAY = 0.25  # [s] after which a line has been read
TRACEBACK = 40  # lines: longer ones are cut


def logged(record: Record, pattern: Pattern[str], until: float = math.inf, since: float = 0.0) -> bool:
    """Return whether a line that the node printed between two times [s] matches."""
    return any(pattern.search(line.text) for line in record.lines if since <= line.time <= until + DELAY)


def logged_cause(record: Record, end: float) -> str:
    """What the log says about why a goal ended wrongly at a time [s]; empty if it says nothing."""
    if any(logged(record, pattern, end, end - JUST_BEFORE) for pattern in (UNCAUGHT, TRACEBACK_LOGGED)):
        return f"An exception was raised: {last_error(record, end)}"
    return NO_STATE if logged(record, NO_STATE_LOGGED, end) else ""


def last_error(record: Record, until: float = math.inf) -> str:
    """The last traceback's last line with the node's own innermost place, or the last line that is not information.

    Lines that were printed later than `until` [s] do not count.

    A place in a library is named only if no traceback has a place outside of libraries.
    """
    printed = [line.text for line in record.lines if line.time <= until + DELAY]
    unstripped = [line for text in printed for line in text.splitlines() if line.strip()]
    lines, ends = [text.strip() for text in unstripped], set(_ends(unstripped))
    errors = [
        number
        for number, line in enumerate(lines)
        if number in ends or "Error" in line.split(":")[0] or "Exception:" in line
    ]
    for only_own in (True, False):
        for number in reversed(errors):
            place = _place(lines[max(0, number - TRACEBACK) : number], only_own)
            if place or not only_own:
                error = PATH_IN_ERROR.sub(r"\1", lines[number])[:200] + place
                return sentences(error, NOT_IMPORTED) if UNKNOWN_TYPE.search(error) else error
    others = [line for line in lines if not INFORMATION.match(line)]
    if not others:
        return "its output names no error"
    return others[-1][:200] if PROBLEM.match(others[-1]) else f"it had printed: {others[-1][:200]}"


def first_error(lines: Sequence[str]) -> str:
    """Type and message of the exception with which these lines begin; the first line if they have no traceback."""
    texts = [text for line in lines for text in line.splitlines() if text.strip()]
    ends = [texts[number].strip() for number in _ends(texts)]
    begins_with_one = any("Traceback" in text for text in texts[:2])
    return PATH_IN_ERROR.sub(r"\1", ends[0] if ends and begins_with_one else texts[0])[:200]


def _ends(lines: Sequence[str]) -> Iterator[int]:
    """Where tracebacks end: the first line after each one's beginning that is not indented."""
    within = False
    for number, line in enumerate(lines):
        if "Traceback (most recent call last):" in line:
            within = True
        elif within and not line[0].isspace():
            within = False
            yield number


def _place(lines: Sequence[str], only_own: bool) -> str:
    """File, line and code of the last traceback in these lines, " (FILE, line N: CODE)"; empty without any."""
    begins = [number for number, line in enumerate(lines) if "Traceback" in line]
    lines = [*lines[begins[-1] if begins else 0 :], ""]
    places = [(found, code) for found, code in zip(map(PLACE.search, lines), lines[1:]) if found]
    own = [(found, code) for found, code in places if not LIBRARY.search(found[1])]
    for found, code in (own if only_own else places)[-1:]:
        quoted = "" if not code or PLACE.search(code) else f": {code[:120]}"
        return f" ({os.path.basename(found[1])}, line {found[2]}{quoted})"
    return ""
