"""Whom a lockstep simulator waits for before simulated time passes a tick: pure bookkeeping, no clock, no threads.

A tick is the number of a control period. Simulated time stands at a tick until nobody is `missing`.

A controller that stamps its answers says which tick each one is for, so it is followed exactly. One that only sends
velocity commands is followed by counting: what arrives after time has moved on from tick k, and before it moves on
from tick k + 1, is its answer to tick k + 1. The gaps between its answers show its rhythm: a 4 Hz loop on 10 Hz ticks
answers after 2, 3, 2, 3, ... of them. Until that is known it may answer at any tick, so each is given a little time.
"""

from dataclasses import dataclass, field
from typing import Dict, List, Optional

LONGEST_GAP = 20  # ticks; who is silent for longer has stopped, or is a new driver when it comes back
LONGEST_RHYTHM = 12  # gaps until they repeat
SURE_AFTER = 4  # gaps that agree, at the least

# How much of the whole time-out is spent on an answer:
SURE = 1.0  # that is due
FIRST = 0.25  # that a new driver gives at the very next tick, if it is a loop at the ticks' own rate, as most are
LEARNING = 0.05  # that may be due or not


@dataclass
class _Controller:
    last: int  # tick of the newest answer
    stamped: bool = False
    awaited: bool = True
    passed: int = -1  # newest tick at which it was not waited for any longer, as it may not have been due
    gaps: List[int] = field(default_factory=list)  # ticks from answer to answer, the newest last

    def next_gap(self) -> Optional[int]:
        """Ticks from the last answer to the next one; None while its rhythm is not known."""
        if self.stamped or (self.gaps and set(self.gaps) == {1}):
            return 1
        settled = self.gaps[1:]  # the first one depends on when the loop was started
        for length in range(1, LONGEST_RHYTHM + 1):
            if len(settled) >= max(2 * length, SURE_AFTER) and settled[length:] == settled[:-length]:
                return settled[-length]
        return None

    def missing(self, tick: int) -> bool:
        """Whether its answer to a tick is waited for."""
        if not self.awaited or self.last >= tick or self.passed >= tick:
            return False
        gap = self.next_gap()
        return gap is None or tick - self.last >= gap

    def patience(self) -> float:
        """How long to wait for it, as a share of the time-out."""
        if self.next_gap() is not None:
            return SURE
        return LEARNING if self.gaps or self.passed > self.last else FIRST


class Lockstep:
    """Controllers by name, and `tick`: the one that the simulator stands at or runs towards; its owner keeps it."""

    def __init__(self, tick: int = 0) -> None:
        self.tick = tick
        self.misses = 0  # answers given up on so far
        self._controllers: Dict[str, _Controller] = {}

    def commanded(self, name: str) -> None:
        """A velocity command came that says nothing of its tick."""
        known = self._controllers.get(name)
        if known is None:
            self._controllers[name] = _Controller(self.tick)
        elif not known.stamped and known.last < self.tick:
            gap = self.tick - known.last
            gaps = (known.gaps + [gap])[-2 * LONGEST_RHYTHM - 1:] if gap <= LONGEST_GAP else []
            self._controllers[name] = _Controller(self.tick, gaps=gaps)

    def answered(self, name: str, tick: int) -> None:
        """An answer came that names its tick; one for a tick that is over only shows that its sender lives."""
        known = self._controllers.get(name)
        last = tick if known is None or not known.stamped else max(tick, known.last)
        self._controllers[name] = _Controller(last, stamped=True)

    def enroll(self, name: str) -> None:
        """A controller that will stamp its answers has connected: it is waited for from now on."""
        if not self.is_stamped(name):
            self._controllers[name] = _Controller(self.tick - 1, stamped=True)

    def is_stamped(self, name: str) -> bool:
        """Whether this controller stamps its answers, so that its plain commands are to be left aside."""
        known = self._controllers.get(name)
        return known is not None and known.stamped

    def gone(self, name: str) -> None:
        """A controller has disconnected."""
        self._controllers.pop(name, None)

    def missing(self) -> List[str]:
        """Who still has to answer the current tick, in alphabetical order."""
        return sorted(name for name, it in self._controllers.items() if it.missing(self.tick))

    def patience(self) -> float:
        """How long to wait for those who are missing, as a share of the time-out."""
        return max((it.patience() for it in self._controllers.values() if it.missing(self.tick)), default=0.0)

    def give_up(self) -> List[str]:
        """Wait no longer at this tick; returns and counts those who were due, lost until they are heard of again."""
        late = []
        for name in self.missing():
            it = self._controllers[name]
            if it.next_gap() is not None:
                late.append(name)
            it.awaited = it.next_gap() is None and self.tick - it.last < LONGEST_GAP
            it.passed = self.tick
        self.misses += len(late)
        return late

    def slower_than_ticks(self) -> bool:
        """Whether somebody is known to answer, in a steady rhythm, more seldom than the ticks come."""
        rhythms = [it.gaps for it in self._controllers.values() if it.next_gap() is not None]
        return any(set(gaps) - {1} for gaps in rhythms)

    def drivers(self) -> List[str]:
        """Who is being waited for, tick by tick."""
        return sorted(name for name, it in self._controllers.items() if it.awaited)

    def restart(self, tick: int) -> None:
        """All was set anew, time perhaps to run towards this tick; who stamps its answers has still to answer it.

        A plain loop's rhythm goes on where time does; where time was set back it has to be learnt again.
        """
        for name, it in self._controllers.items():
            if it.stamped:
                it.last = tick - 1
            elif tick < self.tick:
                self._controllers[name] = _Controller(tick - 1, awaited=it.awaited)
        self.tick = tick
