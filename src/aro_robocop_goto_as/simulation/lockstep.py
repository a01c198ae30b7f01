"""Lockstep: simulated time is held at each control tick until the controllers have answered, or have had their time."""

import math
from dataclasses import dataclass, field
from typing import AbstractSet, Callable, List, Tuple

from .awaited_answers import FIRST, AwaitedAnswers, ControllerId
from .jobs import Clock

DISCONNECT_POLL = 0.05  # [s, wall] between two checks for disconnected controllers while waiting for their answers

SECOND_LOOK = 0.005  # [s, wall] during which what has arrived meanwhile is processed
# [s, wall] rospy.sleep() looks at the time, then waits for up to 0.5 s: a clock message in between does not wake it up.
STILL = 0.6

NodesOf = Callable[[int], AbstractSet[str]]  # names of nodes, by the robot that they are connected to
# Whether a controller is kept from answering, for want of a processor, of which it may use so much [s].
IsKept = Callable[[ControllerId, float], bool]


@dataclass
class TickReport:
    """How a control tick ended."""

    late: List[ControllerId] = field(default_factory=list)  # did not answer in time: time goes on without them
    gone: List[ControllerId] = field(default_factory=list)  # disconnected: their robots are stopped
    slower: List[Tuple[ControllerId, float]] = field(default_factory=list)  # with the rates of their loops [Hz]


class Lockstep:
    """How long to wait for answers; between begin_tick() and the next one, `report` is that of this tick."""

    def __init__(
        self, answers: AwaitedAnswers, timeout: float, clock: Clock, on_gone: Callable[[ControllerId], None]
    ) -> None:
        """`timeout` [s, wall] for the answer of a controller whose turn it is; `on_gone`: one has disconnected."""
        self.timeout = timeout
        self.report = TickReport()
        self._answers, self._clock, self._on_gone = answers, clock, on_gone
        self._held_since = self._next_look = 0.0  # [s, wall]
        self._is_released = False
        self._silent_since = math.inf  # [s, wall] at all looks since then, nobody was kept from answering

    def begin_tick(self) -> None:
        """Simulated time has reached a control tick, and is held."""
        self.report, self._is_released, self._silent_since = TickReport(), False, math.inf
        self._held_since = self._clock.now()
        self._next_look = self._held_since + DISCONNECT_POLL

    def release(self) -> None:
        """Wait for nobody any more at this tick."""
        self._is_released = True

    def hold(self, connected: NodesOf, is_kept: IsKept) -> float:
        """How long to hold simulated time [s, wall] before asking again; 0: nobody is waited for any more.

        After the timeout, a controller is given up only if it is not kept from answering, at each look for some time.
        """
        while not self._is_released and self._answers.missing():
            now = self._clock.now()
            if now >= self._next_look:
                self._forget_disconnected(connected)
                self._next_look = now + DISCONNECT_POLL
                continue
            share = self._answers.patience()
            patience = share * self.timeout
            remaining = self._held_since + patience - now
            if remaining > 0.0:
                return min(remaining, self._next_look - now)
            if any(is_kept(controller, patience) for controller in self._answers.missing()):
                self._silent_since = math.inf
                return self._next_look - now
            self._silent_since = min(self._silent_since, now)
            remaining = self._silent_since + (STILL if share >= FIRST else SECOND_LOOK) - now
            if remaining > 0.0:
                return min(remaining, self._next_look - now)
            self.report.late = self._answers.give_up()
        return 0.0

    def _forget_disconnected(self, connected: NodesOf) -> None:
        for controller in self._answers.missing():
            if controller.node not in connected(controller.robot):
                self.report.gone.append(controller)
                self._answers.gone(controller)
                self._on_gone(controller)
