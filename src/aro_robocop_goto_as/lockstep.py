"""Whom a lockstep simulator waits for before simulated time passes a tick: pure bookkeeping, no clock, no threads.

A tick is the number of a control period. Simulated time stands at a tick until nobody is `missing`.

A controller that stamps its answers says which tick each one is for, so it is followed exactly. One that only sends
velocity commands is followed by counting: what arrives after time has moved on from tick k, and before it moves on
from tick k + 1, is its answer to tick k + 1. From the gaps between its answers its own period is learnt, so a slower
loop is not waited for in between.
"""

from dataclasses import dataclass
from typing import Dict, List

LONGEST_GAP = 10  # ticks; who was silent for longer and comes back is a new driver, expected at every tick at first


@dataclass
class _Controller:
    last: int  # tick of the newest answer
    gap: int = 1  # ticks between answers
    stamped: bool = False
    awaited: bool = True


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
            self._controllers[name] = _Controller(self.tick, gap if gap <= LONGEST_GAP else 1)

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
        return sorted(name for name, it in self._controllers.items()
                      if it.awaited and it.last < self.tick and self.tick - it.last >= it.gap)

    def give_up(self) -> List[str]:
        """Wait no longer for those who are missing, until each is heard of again; returns and counts them."""
        late = self.missing()
        for name in late:
            self._controllers[name].awaited = False
        self.misses += len(late)
        return late

    def drivers(self) -> List[str]:
        """Who is being waited for, tick by tick."""
        return sorted(name for name, it in self._controllers.items() if it.awaited)

    def restart(self, tick: int) -> None:
        """Time was set elsewhere, to run towards this tick; whoever was awaited has still to answer it."""
        self.tick = tick
        for it in self._controllers.values():
            it.last = tick - 1
