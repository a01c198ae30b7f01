"""The nodes whose answers a control tick waits for: whether one is kept from answering, or its answer is under way."""

from typing import Dict, List, Sequence

from ...process.peer import Peer, others_want_to_run
from ...simulation.lockstep import ControllerId
from .robot_inputs import RobotInputs


class AwaitedNodes:
    """What is known of their processes, on this machine, at one control tick; the simulation's owner calls it."""

    def __init__(self, inputs: Sequence[RobotInputs]) -> None:
        self._inputs = inputs
        self._peers: Dict[ControllerId, List[Peer]] = {}

    def begin_tick(self) -> None:
        """Forget those of the tick before."""
        self._peers.clear()

    def is_kept(self, controller: ControllerId, patience: float) -> bool:
        """Whether a controller that has not answered in time may still do so.

        It may as long as it runs or waits for a processor, for up to `patience` [s] of its processor time from the
        first call on, and as long as something that it has sent is not processed.
        """
        if controller not in self._peers:
            ends = self._inputs[controller.robot].sockets_from(controller.node)
            self._peers[controller] = [Peer(end, patience) for end in ends]
        peers = self._peers[controller]
        # In this order: what a process has sent when it is asleep has arrived, and what has arrived wakes a thread up.
        return (
            any(peer.wants_to_run() for peer in peers) or any(peer.has_sent() for peer in peers) or others_want_to_run()
        )
