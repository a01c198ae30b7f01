"""The ROS graph as the master knows it: published topics."""

from dataclasses import dataclass
from typing import List, Tuple

import rosgraph
import rospy


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
