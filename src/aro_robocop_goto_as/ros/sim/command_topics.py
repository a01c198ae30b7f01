"""The topics on which robots are commanded: cmd_vel, and in lockstep the answers to control ticks."""

from functools import partial
from typing import List, Optional, Set

import rospy
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import TickAnswer

from ...errors import CommandError
from ...geometry import Twist2D
from ...names import prefixed
from ...robot.base_controller import require_finite
from ...simulation.lockstep import ControllerId
from ...simulation.running import RunningSimulator
from .. import convert
from ..connected_nodes import publishers_of, sender

# A TurtleBot 2 has a multiplexer before its base (turtlebot_bringup, kobuki_node). Here the newest command counts.
OTHER_TOPICS = {"turtlebot2": ("cmd_vel_mux/input/navi", "cmd_vel_mux/input/teleop", "mobile_base/commands/velocity")}
UNNAMED = "unknown"  # rospy's name for a publisher whose connection is still being made


def _velocity(message: Twist) -> Optional[Twist2D]:
    """The velocity that a message commands; None, with a warning, if it is not finite."""
    twist = convert.from_twist_msg(message)
    try:
        require_finite(twist)
    except CommandError as error:
        rospy.logwarn_throttle(5.0, "%s", error)
        return None
    return twist


class CommandTopics:
    """Subscribers in the robots' namespaces, and what is known of the nodes that publish to them.

    rospy's threads post what arrives to the simulation thread, which calls the methods.
    """

    def __init__(self, running: RunningSimulator) -> None:
        self._running = running
        robots = running.simulator.robots
        self._subscribers = [self._subscribe(number, it.name, it.model.name) for number, it in enumerate(robots)]

    def _subscribe(self, robot: int, name: str, model: str) -> List[rospy.Subscriber]:
        jobs, controllers = self._running.jobs, self._running.controllers

        def on_command(message: Twist) -> None:
            jobs.post(partial(controllers.command, ControllerId(robot, sender(message)), _velocity(message)))

        def on_answer(message: TickAnswer) -> None:
            controller, stamp_ns = ControllerId(robot, sender(message)), message.tick.to_nsec()
            twist = _velocity(message.command) if message.has_command else None
            jobs.post(partial(controllers.answer, controller, stamp_ns, twist))

        # TCP_NODELAY: otherwise the publisher's kernel may hold a command back for 40 ms, at ten times real time 0.4 s.
        subscribers = [
            rospy.Subscriber(prefixed(name, topic), Twist, on_command, tcp_nodelay=True)
            for topic in ("cmd_vel", *OTHER_TOPICS.get(model, ()))
        ]
        if controllers.in_lockstep:
            topic = prefixed(name, "tick_answer")
            subscribers.append(rospy.Subscriber(topic, TickAnswer, on_answer, tcp_nodelay=True))
        return subscribers

    def connected(self) -> Set[ControllerId]:
        """The nodes that are connected to a robot's topics."""
        return {
            ControllerId(robot, node)
            for robot, subscribers in enumerate(self._subscribers)
            for subscriber in subscribers
            for node in publishers_of(subscriber) - {UNNAMED}
        }
