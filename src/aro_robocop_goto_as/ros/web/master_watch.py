"""Watches the ROS master: whether it answers, which robots it knows, and whether it still knows this node."""

import time
from typing import Any, Callable, Dict, List, Tuple

import rospy

from ...errors import MasterError
from ...probes import master
from ...web.state import SharedState
from .daemon import start_daemon

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


def watch_master(state: SharedState, show_problem: Callable[[str], None]) -> None:
    """Start to look every two seconds, in a thread of its own, since the master may hang.

    `show_problem` is called after each look, with an empty string if the master answers.
    """

    def step() -> None:
        problem = look(state)
        state.change(master_problem=problem)
        show_problem(problem)
        time.sleep(PERIOD)

    start_daemon("master watch", step)


def look(state: SharedState) -> str:
    """Why no ROS master answers, or an empty string; updates the robots and `forgotten` in the state."""
    uri, registered = master.master_uri(), state.now.registered
    try:
        types, system = (master.ask_master(uri, request) for request in ("getTopicTypes", "getSystemState"))
    except MasterError as error:
        return str(error)
    except OSError:
        return f"no ROS master at {uri}"
    if types is None or system is None:
        return f"the ROS master at {uri} reports a failure"
    publishers, _, services = system
    forgotten = registered and not _knows_this_node(services)
    state.change(robots=robots_of(dict(types), publishers) or ("",), forgotten=forgotten)
    return f"the ROS master at {uri} was restarted, connecting to it" if forgotten else ""


def _knows_this_node(services: List[Any]) -> bool:
    """Return whether the master has what rospy registered when this node started: the services of its loggers.

    The node's name and address are no proof: each topic that is subscribed to later also registers these, and only
    these, with a master that was started in the meantime.
    """
    name = rospy.get_name()
    return name in dict(services).get(f"{name}/get_loggers", [])
