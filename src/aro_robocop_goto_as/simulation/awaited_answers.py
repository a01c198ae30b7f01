"""Which controllers a lockstep simulator waits for before simulated time passes a tick: bookkeeping without a clock.

A tick is the number of a control period. Simulated time is held at a tick until no controller is `missing`.

A controller that stamps its answers names the tick of each one, so it is followed exactly. If its loop is slower than
the ticks, all of these are multiples of its period, which is known after some answers. A controller that only sends
velocity commands is followed by counting: what arrives after time has left tick k, and before it leaves tick k + 1, is
its answer to tick k + 1. The gaps between its answers show its period: a 4 Hz loop on 10 Hz ticks answers after 2, 3,
2, 3, ... ticks. Until the period is known it may answer at any tick, so the simulator waits briefly at each one.
"""

import math
from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional, Tuple

LONGEST_GAP = 20  # ticks; a controller that is silent for longer has stopped, and counts as new when it returns
LONGEST_PATTERN = 12  # gaps until they repeat
STAMPED_AFTER = 3  # gaps between stamped answers show their period
SURE_AFTER = 4  # gaps, at least, that match the pattern; after a mistake, two of the longest patterns

# Share of the timeout that the simulator waits for an answer:
SURE = 1.0  # that is due
FIRST = 0.25  # of a new controller at the next tick, where it is due if the loop runs at the ticks' rate, as most do
LEARNING = 0.05  # that may be due


@dataclass
class _AnswerRecord:
    last: int  # tick of the newest answer
    stamped: bool = False
    awaited: bool = True
    passed: int = -1  # newest tick at which the wait for it was given up
    gaps: List[int] = field(default_factory=list)  # ticks from answer to answer, the newest last
    mistaken: bool = False  # its gaps have predicted an answer that did not come
    stamps: int = 0  # answers that named their tick, since the last reset
    period: int = 0  # greatest common divisor of the gaps between these

    def next_gap(self) -> Optional[int]:
        """Ticks from the last answer to the next one; None while its period is unknown."""
        if self.stamped:
            return self.period if self.stamps > STAMPED_AFTER else 1
        if self.gaps and set(self.gaps) == {1}:
            return 1
        settled = self.gaps[1:]  # the first one depends on when the loop started
        enough = 2 * LONGEST_PATTERN if self.mistaken else SURE_AFTER  # a pattern may look simpler than it is
        for length in range(1, LONGEST_PATTERN + 1):
            if len(settled) >= max(2 * length, enough) and settled[length:] == settled[:-length]:
                return settled[-length]
        return None

    def missing(self, tick: int) -> bool:
        """Whether the simulator waits for its answer to a tick."""
        if not self.awaited or self.last >= tick or self.passed >= tick:
            return False
        gap = self.next_gap()
        return gap is None or tick - self.last >= gap

    def patience(self) -> float:
        """How long to wait for it, as a share of the timeout."""
        if self.next_gap() is not None:
            return SURE
        return LEARNING if self.gaps or self.passed > self.last else FIRST


class ControllerId(NamedTuple):
    """A node that commands a robot."""

    robot: int
    node: str


class AwaitedAnswers:
    """Controllers by name, and the tick at which time stands or towards which it runs; the owner sets `tick`."""

    def __init__(self, tick: int = 0) -> None:
        self.tick = tick
        self.misses = 0  # answers given up on so far
        self._controllers: Dict[ControllerId, _AnswerRecord] = {}
        self._slower: List[Tuple[ControllerId, int]] = []

    def commanded(self, name: ControllerId) -> None:
        """Note a velocity command that does not name its tick."""
        known = self._controllers.get(name)
        if known is None:
            self._controllers[name] = _AnswerRecord(self.tick)
        elif not known.stamped and known.last < self.tick:
            gap = self.tick - known.last
            gaps = (known.gaps + [gap])[-2 * LONGEST_PATTERN - 1 :] if gap <= LONGEST_GAP else []
            self._controllers[name] = _AnswerRecord(self.tick, gaps=gaps, mistaken=known.mistaken)

    def answered(self, name: ControllerId, tick: int) -> None:
        """Note an enrolled controller's answer; one for an earlier tick only shows that its sender is alive."""
        known = self._controllers.get(name)
        if known is None or not known.stamped:
            return  # not enrolled yet
        known.awaited, known.passed = True, -1
        if tick > known.last:
            period = math.gcd(known.period, tick - known.last) if known.stamps else 0
            known.last, known.period, known.stamps = tick, period, known.stamps + 1
            if known.stamps == STAMPED_AFTER + 1 and period > 1:
                self._slower.append((name, period))

    def enroll(self, name: ControllerId) -> None:
        """Wait from the next tick on for a controller that stamps its answers and has connected.

        It may have answered this tick before it was connected, or have connected too late to be told of it.
        """
        if not self.is_stamped(name):
            self._controllers[name] = _AnswerRecord(self.tick, stamped=True)

    def is_stamped(self, name: ControllerId) -> bool:
        """Whether this controller stamps its answers, so that its plain commands have to be ignored."""
        known = self._controllers.get(name)
        return known is not None and known.stamped

    def gone(self, name: ControllerId) -> None:
        """Forget a controller that has disconnected."""
        self._controllers.pop(name, None)

    def missing(self) -> List[ControllerId]:
        """The controllers that still have to answer the current tick, sorted."""
        return sorted(name for name, known in self._controllers.items() if known.missing(self.tick))

    def patience(self) -> float:
        """How long to wait for the missing controllers, as a share of the timeout."""
        return max((known.patience() for known in self._controllers.values() if known.missing(self.tick)), default=0.0)

    def give_up(self) -> List[ControllerId]:
        """Stop waiting at this tick; returns and counts the controllers that were due, dropped until heard again."""
        late = []
        for name in self.missing():
            known = self._controllers[name]
            was_due = known.next_gap() is not None
            known.awaited = not was_due and self.tick - known.last < LONGEST_GAP
            if was_due:
                late.append(name)
                known.mistaken = True
            known.passed = self.tick
        self.misses += len(late)
        return late

    def take_slower(self) -> List[Tuple[ControllerId, int]]:
        """Controllers that answer only each N-th tick, with N, of which that became known since the last call."""
        slower, self._slower = self._slower, []
        return slower

    def awaited(self) -> List[ControllerId]:
        """The controllers that are waited for, sorted."""
        return sorted(name for name, known in self._controllers.items() if known.awaited)

    def restart(self, tick: int) -> None:
        """The simulation was reset and runs towards this tick, which stamping controllers still have to answer.

        The period of a plain loop stays known.
        """
        for known in self._controllers.values():
            if known.stamped:
                known.last, known.stamps, known.period = tick - 1, 0, 0
        self.tick = tick
