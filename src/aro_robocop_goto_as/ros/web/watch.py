"""Watches the ROS master, from a thread of its own, since it may hang."""

import threading
import time
from contextlib import suppress
from typing import List, Optional, Tuple

import rosgraph
import rospy

from ...bootstrap import master
from ...errors import MasterError
from .. import graph

PERIOD = 2.0  # [s, wall]
ODOMETRY, ODOM = "nav_msgs/Odometry", "/odom"


def problem_of_master() -> str:
    """Why there is no ROS master, or an empty string."""
    uri = master.master_uri()
    try:
        return "" if master.master_answers(uri) else f"no ROS master at {uri}"
    except MasterError as error:
        return str(error)


def robots_of(topics: List[graph.Topic]) -> Tuple[str, ...]:
    """Namespaces of the robots: those with odometry on a topic called odom; "" for a robot without a namespace."""
    return tuple(
        topic.name[: -len(ODOM)].lstrip("/") for topic in topics if topic.type == ODOMETRY and topic.name.endswith(ODOM)
    )


class MasterWatch:
    """What was found last; a daemon thread looks again every two seconds until shutdown."""

    def __init__(self) -> None:
        self.problem = ""
        self.forgotten = False  # the master answers, but is another one than this node registered with
        self.robots: Optional[Tuple[str, ...]] = None
        threading.Thread(target=self._run, daemon=True, name="master watch").start()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            self._look()
            time.sleep(PERIOD)

    def _look(self) -> None:
        problem = problem_of_master()
        if not problem:
            # The connection may break between two requests; then the next look says so.
            with suppress(OSError, rosgraph.MasterException):
                self.forgotten = not self._is_registered()
                self.robots = robots_of(graph.published_topics())
        self.problem = problem

    @staticmethod
    def _is_registered() -> bool:
        """Whether the master knows this process under its name."""
        try:
            return rosgraph.Master(rospy.get_name()).lookupNode(rospy.get_name()) == rospy.get_node_uri()
        except rosgraph.MasterError:
            return False
