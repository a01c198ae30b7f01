"""Topics that the node publishes or subscribes to with another type than the robot's or the action's."""

import re

from ..handout import ACTION, ACTION_TYPE
from ..record import Record


def other_action(found: str) -> str:
    """What is wrong with an action of another type than the handout's."""
    return f"The action's type is {found}; the handout's is GoToPositionAction of aro_robocop_goto_as"


def wrong_type(record: Record, *topics: str) -> str:
    """What is wrong with the first of these topics that has another type; empty if all types are right."""
    for topic, found, expected in record.other_types:
        if topic in topics:
            action = re.sub("(Goal|Result|Feedback)$", "", found)
            if topic.startswith(f"{ACTION}/") and action != found and action != ACTION_TYPE:
                return other_action(action)
            if found == expected:
                return f"{topic} is used with the type {found}, but with other fields than its own"
            return f"{topic} is used with the wrong type, {found}; its type is {expected}"
    return ""
