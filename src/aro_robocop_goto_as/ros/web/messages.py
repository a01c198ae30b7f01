"""Messages of any type as text."""

from typing import Any, List, Optional

import genpy
import roslib.message
import rospy

LINES, WIDTH = 60, 120  # of a message in full: lines, characters of a line
BRIEF = 100  # characters of a message on one line


def class_of(kind: str) -> Any:
    """The class of a type, such as geometry_msgs/Twist; one of unread bytes where the type's package is not built here.

    rospy has one class for all subscribers of a topic, so it has to be the one that other parts use.
    """
    return roslib.message.get_message_class(kind) or rospy.AnyMsg


def _lines(message: Any, fields: Optional[Any] = None) -> List[str]:
    if isinstance(message, rospy.AnyMsg):
        return ["a message of a type that is not built here"]
    return str(genpy.message.strify_message(message, field_filter=fields)).splitlines()


def full(message: Any) -> str:
    """As `rostopic echo` shows it, with long lines and long messages cut."""
    lines = _lines(message)
    return "\n".join([_cut(line, WIDTH) for line in lines[:LINES]] + ["…"] * (len(lines) > LINES))


def brief(message: Any) -> str:
    """On one line, without its header."""
    return _cut(" ".join(" ".join(_lines(message, _without_header)).split()), BRIEF)


def _without_header(message: Any) -> List[str]:
    return [name for name in message.__slots__ if name != "header"]


def _cut(line: str, width: int) -> str:
    return line if len(line) <= width else line[: width - 1] + "…"
