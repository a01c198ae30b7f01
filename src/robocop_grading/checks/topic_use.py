"""What is wrong with the topics that the node uses: another type, nobody who publishes, a callback that is too slow."""

import re
from typing import Mapping, Pattern

from aro_robocop_goto_as.names import ACTION_TYPE

from ..handout import ACTION
from ..record import Record

MIN_DELAY = 1.0  # [s] a callback that waits once at the start makes messages wait for less


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


def unpublished(records: Mapping[str, Record], name: Pattern[str]) -> str:
    """The first topic with such a name that the node subscribes to and nobody publishes; empty if there is none."""
    topics = [topic for record in records.values() for topic in record.unpublished]
    return next(filter(name.search, topics), "")


def late(records: Mapping[str, Record], name: Pattern[str], what: str) -> str:
    """A sentence: data is old because the callback of a topic with such a name is too slow; empty if no callback is."""
    delays = [(delay, topic) for record in records.values() for topic, delay in record.delays if name.search(topic)]
    delays = [it for it in delays if it[0] >= MIN_DELAY]
    if not delays:
        return ""
    delay, topic = max(delays)
    return (
        f"{what}: messages on {topic} waited up to {delay:.3g} s for their callback, because it takes longer than the "
        "time from one message to the next. It has to store what it needs and return at once, without a sleep or a "
        "long calculation"
    )
