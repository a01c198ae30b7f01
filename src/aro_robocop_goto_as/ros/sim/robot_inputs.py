"""The topics on which one robot is commanded: cmd_vel, and in lockstep the answers to control ticks."""

from typing import Callable, List, Optional, Set

import rospy
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import TickAnswer

from ...geometry import Twist2D
from .. import convert
from ..private_api import publishers_of, sender
from .answering_nodes import AnsweringNodes
from .robot_topics import prefixed

UNNAMED = "unknown"  # rospy's name for a publisher whose connection is still being made

OnCommand = Callable[[str, Twist2D], None]  # node, velocity
OnAnswer = Callable[[str, int, Optional[Twist2D]], None]  # node, stamp of the tick [ns], velocity


class RobotInputs:
    """Subscribers in a robot's namespace; the callbacks are called from rospy's threads."""

    def __init__(self, name: str, lockstep: bool, on_command: OnCommand, on_answer: OnAnswer) -> None:
        def command(message: Twist) -> None:
            on_command(sender(message), convert.from_twist_msg(message))

        def answer(message: TickAnswer) -> None:
            twist = convert.from_twist_msg(message.command) if message.has_command else None
            on_answer(sender(message), convert.to_ns(message.tick), twist)

        # TCP_NODELAY: otherwise the publisher's kernel may hold a command back for 40 ms, at ten times real time 0.4 s.
        self._commands = rospy.Subscriber(prefixed(name, "cmd_vel"), Twist, command, tcp_nodelay=True)
        self._answers: Optional[rospy.Subscriber] = None
        self._answering = AnsweringNodes()
        if lockstep:
            self._answers = rospy.Subscriber(prefixed(name, "tick_answer"), TickAnswer, answer, tcp_nodelay=True)

    def _inputs(self) -> List[rospy.Subscriber]:
        return [self._commands] if self._answers is None else [self._commands, self._answers]

    def connected(self) -> Set[str]:
        """Names of the nodes that are connected to these topics."""
        return set().union(*map(publishers_of, self._inputs()))

    def answering(self) -> Set[str]:
        """Names of the nodes that are connected to answer ticks and to all they subscribe to."""
        if self._answers is None:
            return set()
        return self._answering.among(publishers_of(self._answers) - {UNNAMED})
