"""The topics on which robots are commanded: cmd_vel, and in lockstep the answers to control ticks."""

import threading
from functools import partial
from typing import Callable, Dict, Iterable, List, Optional, Set

import rosgraph
import rospy
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import TickAnswer

from ...errors import CommandError
from ...geometry import Twist2D
from ...process.peer import Peer, others_want_to_run
from ...robot.base_controller import require_finite
from ...simulation.awaited_answers import ControllerId
from ...simulation.simulation import Simulation
from .. import convert, graph
from ..names import prefixed
from ..rospy_internals import is_topic_connected_to, publishers_of, sender, socket_from
from ..waiting import wait_until

UNNAMED = "unknown"  # rospy's name for a publisher whose connection is still being made
POLL = 0.02  # [s, wall] between two checks of a node's connections
PATIENCE = 10.0  # [s, wall, and of its processor time] for them; a killed node may have left a registration


def is_fully_connected(node: str) -> bool:
    """Whether all subscriptions of `node` to topics of this node, as the master knows them, are connected."""
    try:
        topics = graph.topics_between(rospy.get_name(), node)
    except (OSError, rosgraph.MasterException):
        return True  # unknown: the master does not answer
    return all(is_topic_connected_to(topic, node) for topic in topics)


def _velocity(message: Twist) -> Optional[Twist2D]:
    """The velocity that a message commands; None, with a warning, if it is not finite."""
    twist = convert.from_twist_msg(message)
    try:
        require_finite(twist)
    except CommandError as error:
        rospy.logwarn_throttle(5.0, "%s", error)
        return None
    return twist


class AnsweringNodes:
    """Finds the nodes whose subscriptions to this node have all connected.

    They connect one by one and in any order. If lockstep waited for a node whose scan is not connected yet, the first
    scans would be lost, and a run that starts at once would depend on how fast the machine is. Each new node is looked
    at in a thread of its own, as the master may take long to answer.
    """

    def __init__(
        self,
        is_ready: Callable[[str], bool] = is_fully_connected,
        patience: float = PATIENCE,
        peer_of: Callable[[str], Optional[Peer]] = lambda node: None,
    ) -> None:
        """`peer_of`: a node's process, which is waited for while it waits for a processor."""
        self._is_ready, self._patience, self._peer_of = is_ready, patience, peer_of
        self._looks: Dict[str, threading.Thread] = {}  # by node; one ends when all is connected since the node came

    def among(self, connected: Iterable[str]) -> Set[str]:
        """Those of the connected nodes that are ready; call it often, and from one thread."""
        self._looks = {node: self._looks.get(node) or self._look_at(node) for node in {*connected}}
        return {node for node, look in self._looks.items() if not look.is_alive()}

    def _look_at(self, node: str) -> threading.Thread:
        look = threading.Thread(target=self._await, args=(node,), name=f"connections of {node}", daemon=True)
        look.start()
        return look

    def _await(self, node: str) -> None:
        peer = None
        while not (wait_until(lambda: self._is_ready(node), self._patience, POLL) or rospy.is_shutdown()):
            peer = peer or self._peer_of(node)
            if peer is None or not peer.wants_to_run():
                rospy.logwarn("%s answers ticks, but not all of its subscriptions have connected", node)
                return


class CommandTopics:
    """Subscribers in the robots' namespaces, and what is known of the nodes that publish to them.

    rospy's threads post what arrives to the simulation's owner, who calls the methods.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        names = [robot.name for robot in simulation.simulator.robots]
        self._subscribers = [self._subscribe(robot, name) for robot, name in enumerate(names)]
        self._answering = [AnsweringNodes(peer_of=partial(self._peer, robot)) for robot in range(len(names))]
        self._peers: Dict[ControllerId, List[Peer]] = {}  # that are awaited at this control tick

    def _subscribe(self, robot: int, name: str) -> List[rospy.Subscriber]:
        jobs, controllers = self._simulation.jobs, self._simulation.controllers

        def on_command(message: Twist) -> None:
            jobs.post(partial(controllers.command, ControllerId(robot, sender(message)), _velocity(message)))

        def on_answer(message: TickAnswer) -> None:
            controller, stamp_ns = ControllerId(robot, sender(message)), convert.to_ns(message.tick)
            twist = _velocity(message.command) if message.has_command else None
            jobs.post(partial(controllers.answer, controller, stamp_ns, twist))

        # TCP_NODELAY: otherwise the publisher's kernel may hold a command back for 40 ms, at ten times real time 0.4 s.
        subscribers = [rospy.Subscriber(prefixed(name, "cmd_vel"), Twist, on_command, tcp_nodelay=True)]
        if controllers.in_lockstep:
            topic = prefixed(name, "tick_answer")
            subscribers.append(rospy.Subscriber(topic, TickAnswer, on_answer, tcp_nodelay=True))
        return subscribers

    def connected(self, robot: int) -> Set[str]:
        """Names of the nodes that are connected to a robot's topics."""
        return set().union(*map(publishers_of, self._subscribers[robot]))

    def answering(self, robot: int) -> Set[str]:
        """Names of the nodes that are connected to answer ticks for a robot, and to all they subscribe to."""
        _, answers = self._subscribers[robot]
        return self._answering[robot].among(publishers_of(answers) - {UNNAMED})

    def _peer(self, robot: int, node: str) -> Optional[Peer]:
        end = socket_from(self._subscribers[robot][1], node)
        return None if end is None else Peer(end, PATIENCE)

    def begin_tick(self) -> None:
        """Forget the processes that were looked at in the tick before."""
        self._peers.clear()

    def is_kept(self, controller: ControllerId, patience: float) -> bool:
        """Whether a controller on this machine that has not answered in time may still do so.

        It may as long as it runs or waits for a processor, for up to `patience` [s] of its processor time from the
        first call on, and as long as something that it has sent is not processed.
        """
        if controller not in self._peers:
            ends = [socket_from(subscriber, controller.node) for subscriber in self._subscribers[controller.robot]]
            self._peers[controller] = [Peer(end, patience) for end in ends if end is not None]
        peers = self._peers[controller]
        # In this order: what a process has sent when it is asleep has arrived, and what has arrived wakes a thread up.
        return (
            any(peer.wants_to_run() for peer in peers) or any(peer.has_sent() for peer in peers) or others_want_to_run()
        )
