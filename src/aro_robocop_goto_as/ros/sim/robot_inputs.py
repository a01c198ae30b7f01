"""The topics on which one robot is commanded: cmd_vel, and in lockstep the answers to control ticks."""

import socket
from typing import List, Optional, Set

import rospy
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import TickAnswer

from ...simulation.lockstep import ControllerId
from ...simulation.simulation import Simulation
from .. import convert
from ..names import prefixed
from ..rospy_internals import publishers_of, sender, socket_from
from .answering_nodes import AnsweringNodes

UNNAMED = "unknown"  # rospy's name for a publisher whose connection is still being made


class RobotInputs:
    """Subscribers in a robot's namespace; rospy's threads post what arrives to the simulation's owner."""

    def __init__(self, simulation: Simulation, robot: int) -> None:
        def on_command(message: Twist) -> None:
            controller, twist = ControllerId(robot, sender(message)), convert.from_twist_msg(message)
            simulation.jobs.post(lambda: simulation.controllers.command(controller, twist))

        def on_answer(message: TickAnswer) -> None:
            controller, stamp_ns = ControllerId(robot, sender(message)), convert.to_ns(message.tick)
            twist = convert.from_twist_msg(message.command) if message.has_command else None
            simulation.jobs.post(lambda: simulation.controllers.answer(controller, stamp_ns, twist))

        # TCP_NODELAY: otherwise the publisher's kernel may hold a command back for 40 ms, at ten times real time 0.4 s.
        name = simulation.simulator.robots[robot].name
        self._commands = rospy.Subscriber(prefixed(name, "cmd_vel"), Twist, on_command, tcp_nodelay=True)
        self._answers: Optional[rospy.Subscriber] = None
        self._answering = AnsweringNodes()
        if simulation.controllers.in_lockstep:
            self._answers = rospy.Subscriber(prefixed(name, "tick_answer"), TickAnswer, on_answer, tcp_nodelay=True)

    def _inputs(self) -> List[rospy.Subscriber]:
        return [self._commands] if self._answers is None else [self._commands, self._answers]

    def connected(self) -> Set[str]:
        """Names of the nodes that are connected to these topics."""
        return set().union(*map(publishers_of, self._inputs()))

    def sockets_from(self, node: str) -> List[socket.socket]:
        """On which a node's commands and answers arrive."""
        found = [socket_from(subscriber, node) for subscriber in self._inputs()]
        return [end for end in found if end is not None]

    def answering(self) -> Set[str]:
        """Names of the nodes that are connected to answer ticks and to all they subscribe to."""
        if self._answers is None:
            return set()
        return self._answering.among(publishers_of(self._answers) - {UNNAMED})
