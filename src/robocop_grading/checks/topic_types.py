"""Topics that the node publishes or subscribes to with another type than the robot's or the action's."""

import re

from ..handout import ACTION, ACTION_TYPE
from ..record import Record
from ..texts import text


def wrong_type(record: Record, *topics: str) -> str:
    """What is wrong with the first of these topics that has another type; empty if all types are right."""
    for topic, found, expected in record.other_types:
        if topic in topics:
            action = re.sub("(Goal|Result|Feedback)$", "", found)
            if topic.startswith(f"{ACTION}/") and action != found and action != ACTION_TYPE:
                return text("other_type", action)
            return (
                text("wrong_fields", topic, found) if found == expected else text("wrong_type", topic, found, expected)
            )
    return ""
