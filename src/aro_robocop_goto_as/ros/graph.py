"""The ROS graph as the master knows it: published topics, topics between two nodes, action servers."""

from dataclasses import dataclass
from typing import Dict, List, Tuple

import rosgraph
import rospy

# Topics of an action's server and clients, after its name; their types end in ActionResult and ActionGoal.
RESULT, GOAL = "/result", "/goal"


@dataclass(frozen=True)
class Topic:
    """A topic with its message type ("" when the master does not know it) and the names of its publishers."""

    name: str
    type: str
    publishers: Tuple[str, ...]


def published_topics() -> List[Topic]:
    """All topics that have a publisher, by name; OSError or rosgraph.MasterException when the master does not answer.

    The master also lists nodes that were killed and could not unregister.
    """
    master = rosgraph.Master(rospy.get_name())
    types = dict(master.getTopicTypes())
    publishers, _, _ = master.getSystemState()
    return sorted(
        (Topic(name, types.get(name, ""), tuple(nodes)) for name, nodes in publishers if nodes),
        key=lambda topic: topic.name,
    )


def unpublished_topics() -> List[str]:
    """Names of topics that another node subscribes to and nobody publishes; raises what published_topics raises."""
    publishers, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
    published = {topic for topic, nodes in publishers if nodes}
    return sorted(topic for topic, nodes in subscribers if {*nodes} - {rospy.get_name()} and topic not in published)


def action_servers() -> Dict[str, str]:
    """Action type of each action server, by name: {"/robocop_goto_as": "aro_robocop_goto_as/GoToPositionAction"}."""
    return _actions(RESULT)


def action_clients() -> Dict[str, str]:
    """The same for the action servers that action clients look for, whether or not they exist."""
    return _actions(GOAL)


def _actions(suffix: str) -> Dict[str, str]:
    kind = suffix[1:].capitalize()
    return {
        topic.name[: -len(suffix)]: topic.type[: -len(kind)]
        for topic in published_topics()
        if topic.name.endswith(suffix) and topic.type.endswith(f"Action{kind}")
    }
