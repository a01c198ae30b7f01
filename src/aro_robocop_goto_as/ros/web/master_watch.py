"""Watches the ROS master, from a thread of its own, since it may hang."""

import threading
import time
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from ...bootstrap import master
from ...errors import MasterError

PERIOD = 2.0  # [s, wall]
ODOMETRY, ODOM = "nav_msgs/Odometry", "/odom"


def robots_of(types: Dict[str, str], publishers: List[Tuple[str, List[str]]]) -> Tuple[str, ...]:
    """Namespaces of the robots: those with odometry on a topic called odom; "" for a robot without a namespace."""
    return tuple(
        sorted(
            topic[: -len(ODOM)].lstrip("/")
            for topic, nodes in publishers
            if nodes and topic.endswith(ODOM) and types.get(topic) == ODOMETRY
        )
    )


class MasterWatch:
    """What was found last; a daemon thread looks again every two seconds until shutdown."""

    def __init__(self, show_problem: Callable[[str], None]) -> None:
        """`show_problem` is called by the thread after each look, with an empty string if the master answers."""
        self.problem = "it has not been asked yet"
        self.registered = False  # set by the node: from now on the master should know it
        self.forgotten = False  # the master answers, but is another one than this node registered with
        self.robots: Optional[Tuple[str, ...]] = None
        self._show_problem = show_problem
        threading.Thread(target=self._run, daemon=True, name="master watch").start()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            self.problem = self._look()
            self._show_problem(self.problem)
            time.sleep(PERIOD)

    def _look(self) -> str:
        """Why there is no ROS master, or an empty string."""
        uri, registered = master.master_uri(), self.registered
        try:
            types, state = (master.ask_master(uri, request) for request in ("getTopicTypes", "getSystemState"))
        except MasterError as error:
            return str(error)
        except OSError:
            return f"no ROS master at {uri}"
        if types is None or state is None:
            return f"the ROS master at {uri} reports a failure"
        publishers, _, services = state
        self.robots = robots_of(dict(types), publishers)
        self.forgotten = registered and not _knows_this_node(services)
        return f"the ROS master at {uri} was restarted, connecting to it" if self.forgotten else ""


def _knows_this_node(services: List[Any]) -> bool:
    """Whether the master has what rospy registered when this node started: the services of its loggers.

    The node's name and address are no proof: each topic that is subscribed to later also registers these, and only
    these, with a master that was started in the meantime.
    """
    name = rospy.get_name()
    return name in dict(services).get(f"{name}/get_loggers", [])
