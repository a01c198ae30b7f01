"""Lockstep: simulated time stops at each control tick until the controllers have answered, or have had their time.

A control tick is the end of a control period; both are numbered. A node that answers ticks (`tick_answer`) says which
tick each answer is for. Any other node that is connected to cmd_vel has answered a tick when one of its commands has
arrived in the period that ends with it.
The simulator waits until the timeout for a node that is expected to answer, and only for SILENCE_TIMEOUT for any other
node. A node that answers ticks is expected from its first answer on, any other node once it has answered two ticks in a
row. After a timeout, either has to answer two ticks in a row to be expected again.
"""

from dataclasses import dataclass, field
from typing import AbstractSet, Callable, Dict, List, NamedTuple, Set

from .jobs import WallClock

SILENCE_TIMEOUT = 0.02  # [s, wall] for a node that is not expected to answer
EXPECTED_AFTER = 2  # ticks that a node has answered in a row
DISCONNECT_PERIOD = 0.05  # [s, wall] between two checks for disconnected nodes while time is held


class ControllerId(NamedTuple):
    """A node that commands a robot."""

    robot: int
    node: str


Connected = Callable[[], AbstractSet[ControllerId]]


@dataclass
class TickOutcome:
    """How a control tick ended."""

    late: List[ControllerId] = field(default_factory=list)  # for the first time, did not answer before the timeout
    gone: List[ControllerId] = field(default_factory=list)  # were expected and have disconnected


@dataclass
class _Controller:
    last_answered: int  # period
    answers_ticks: bool = False
    in_a_row: int = 0  # ticks that it has answered since it was last given up

    def note(self, period: int) -> None:
        if period > self.last_answered:
            self.in_a_row += 1
            self.last_answered = period

    @property
    def is_expected(self) -> bool:
        return self.in_a_row >= EXPECTED_AFTER


class Lockstep:
    """Which controllers simulated time waits for at a tick, and for how long."""

    def __init__(self, timeout: float, clock: WallClock) -> None:
        """`timeout` [s, wall] for the answer of a node that is expected to answer."""
        self.timeout = timeout
        self.misses = 0  # answers of expected nodes that did not come in time
        self.outcome = TickOutcome()  # of the tick since the last begin_tick()
        self._clock = clock
        self._controllers: Dict[ControllerId, _Controller] = {}
        self._warned: Set[ControllerId] = set()
        self._held_since = self._next_check = 0.0  # [s, wall]

    def commanded(self, name: ControllerId, period: int) -> None:
        """Note a velocity command that arrived in a period, from a node that names no ticks."""
        self._controllers.setdefault(name, _Controller(period - 1)).note(period)

    def answered(self, name: ControllerId, period: int) -> None:
        """Note an answer to the tick that ends a period; the first one makes its node one that answers ticks."""
        known = self._controllers.get(name)
        if known is None or not known.answers_ticks:
            self._controllers[name] = _Controller(period, answers_ticks=True, in_a_row=EXPECTED_AFTER)
        else:
            known.note(period)

    def answers_ticks(self, name: ControllerId) -> bool:
        """Return whether this node answers ticks."""
        known = self._controllers.get(name)
        return known is not None and known.answers_ticks

    def expected(self) -> List[ControllerId]:
        """The nodes that are expected to answer the next tick, sorted."""
        return sorted(name for name, known in self._controllers.items() if known.is_expected)

    def begin_tick(self, period: int, connected: Connected) -> None:
        """Simulated time has reached the end of a period, and is held for the nodes that are connected."""
        self.outcome = TickOutcome()
        self._held_since = self._clock.now()
        self._update(period, connected())

    def hold_time(self, period: int, connected: Connected) -> float:
        """How long to hold simulated time after a period [s, wall] before asking again; 0: nobody is waited for."""
        while True:
            missing = [known for known in self._controllers.values() if known.last_answered < period]
            if not missing:
                return 0.0
            now = self._clock.now()
            timeout = self.timeout if any(known.is_expected for known in missing) else SILENCE_TIMEOUT
            remaining = self._held_since + timeout - now
            if remaining <= 0.0:
                self._give_up(period)
                return 0.0
            if now < self._next_check:
                return min(remaining, self._next_check - now)
            self._update(period, connected())

    def _update(self, period: int, connected: AbstractSet[ControllerId]) -> None:
        """Add the nodes that have connected, and forget those that have disconnected."""
        self._next_check = self._clock.now() + DISCONNECT_PERIOD
        for name in self._controllers.keys() - connected:
            if self._controllers.pop(name).is_expected:
                self.outcome.gone.append(name)
        for name in connected - self._controllers.keys():
            self._controllers[name] = _Controller(period - 1)

    def _give_up(self, period: int) -> None:
        """Let time go on without the nodes that are missing, none of which is expected at the next tick."""
        for name, known in self._controllers.items():
            if known.last_answered < period:
                if known.is_expected:
                    self.misses += 1
                    if name not in self._warned:
                        self._warned.add(name)
                        self.outcome.late.append(name)
                known.in_a_row = 0
