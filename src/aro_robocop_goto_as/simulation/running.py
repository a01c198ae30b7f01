"""A simulator that runs: the loop around its steps, with the wall clock, controllers and the jobs of other threads."""

from typing import AbstractSet, Callable, Iterator, NamedTuple, Optional

from .agenda import StepEvents, Subscriptions
from .controllers import Controllers
from .jobs import Jobs, WallClock
from .lockstep import Connected, TickOutcome
from .simulator import Change, Simulator
from .time_control import TimeControl

MAX_SLEEP = 0.05  # [s, wall] while asleep, jobs wait; a longer wait runs them as they come, at four times the cost


class Round(NamedTuple):
    """What the owner of a running simulator is to publish now; often nothing, while time stands still."""

    due: Optional[StepEvents] = None  # of the newest step
    more: bool = False  # the next step's messages follow at once
    changes: AbstractSet[Change] = frozenset()  # other than by a step, to be published again; at the start everything
    clock: bool = False  # publish the time again at which the simulation stands, for nodes that have started meanwhile
    outcome: Optional[TickOutcome] = None  # in lockstep, of the control tick that has ended


class RunningSimulator:
    """Its owner's thread iterates over rounds(); other threads only post jobs, which are run between two steps."""

    def __init__(
        self, simulator: Simulator, clock: Optional[WallClock] = None, stopped: Callable[[], bool] = lambda: False
    ) -> None:
        """`clock`: the machine's if None; `stopped`: asked in each round of the loop whether to end it."""
        params, self._clock, self._stopped = simulator.params, clock or WallClock(), stopped
        self.simulator = simulator
        self.jobs = Jobs(self._clock, stopped)
        self.time_control = TimeControl(params.time, simulator.rate, self._clock)
        self.controllers = Controllers(simulator, params.lockstep, self._clock)

    def set_paused(self, paused: bool) -> None:
        """Pause or resume simulated time; during a span, from its end on."""
        self.time_control.set_paused(paused, self.simulator.steps)
        self.simulator.changes.add(Change.PAUSED)

    def rounds(self, subscriptions: Callable[[], Subscriptions], connected: Connected) -> Iterator[Round]:
        """Simulate until stopped: clock ticks wait for the wall clock, lockstep control ticks for the controllers.

        subscriptions: topic of a sensor -> the robots for which somebody subscribes to it; asked for at clock ticks
        connected: the nodes that may command a robot; asked for in lockstep
        """
        simulator, time, controllers = self.simulator, self.time_control, self.controllers
        time.pacer.restart(simulator.steps)
        simulator.changes = set(Change)
        yield from self._pace()
        subscribed = subscriptions()
        while not self._stopped():
            due = simulator.advance(subscribed, time.steps_left(simulator.steps))
            if due is not None:
                yield Round(due, more=time.as_fast_as_possible and not due.control)
                if due.control and controllers.in_lockstep:
                    controllers.begin_tick(connected)
                    yield from self._hold(lambda: controllers.hold_time(connected))
                    yield Round(outcome=controllers.end_tick())
            if time.end_span(simulator.steps) or (due is not None and due.clock):
                yield from self._pace()
                subscribed = subscriptions()

    def _pace(self) -> Iterator[Round]:
        """Run the jobs that have come, and hold simulated time until the wall clock has reached it."""
        time, simulator = self.time_control, self.simulator
        self.jobs.run_queued()
        yield self._changed()
        wait = time.hold_time(simulator.steps)
        if 0.0 < wait < MAX_SLEEP:  # jobs that come meanwhile take effect from the next step on, as if they ran at once
            self._clock.sleep(wait)
            time.pacer.waited(wait)
            self.jobs.run_queued()
            yield self._changed()
            wait = time.hold_time(simulator.steps)
        if wait > 0.0:
            yield from self._hold(lambda: time.hold_time(simulator.steps))

    def _changed(self, clock: bool = False) -> Round:
        """A round without a step."""
        changes, self.simulator.changes = self.simulator.changes, set()
        if Change.RESET in changes:
            self.time_control.pacer.restart(self.simulator.steps)
        return Round(changes=changes, clock=clock)

    def _hold(self, hold: Callable[[], float]) -> Iterator[Round]:
        """Run the jobs of other threads for as long as `hold` says that simulated time has to wait [s, wall]."""
        pacer = self.time_control.pacer
        started, wait = pacer.now(), hold()
        while wait > 0.0 and not self._stopped():
            self.jobs.run_next(wait)
            yield self._changed(self.time_control.repetition_due())
            wait = hold()
        pacer.waited(pacer.now() - started)
