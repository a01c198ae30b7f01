"""A simulator that runs: the loop around its steps, with the wall clock, controllers and the jobs of other threads."""

from typing import AbstractSet, Callable, Optional

from .agenda import Due, Subscriptions
from .controllers import Controllers
from .jobs import Jobs, WallClock
from .lockstep import ControllerId, TickReport
from .simulator import Change, Simulator
from .time_control import TimeControl

MAX_SLEEP = 0.05  # [s, wall] a sleep during which jobs may wait; waiting for jobs costs four times the processor time


class Outputs:
    """What a running simulator publishes to, and asks who listens and commands; called by the thread of the loop."""

    def subscriptions(self) -> Subscriptions:
        """Topic of a sensor -> the robots for which somebody subscribes to it; asked for at clock ticks."""
        return {}

    def connected(self) -> AbstractSet[ControllerId]:
        """The nodes that may command a robot; asked for in lockstep."""
        return frozenset()

    def publish(self, due: Due, more: bool) -> None:
        """Publish what is due on this step; `more`: the next step's messages follow at once."""

    def publish_changes(self, changes: AbstractSet[Change]) -> None:
        """Publish again what has changed other than by a step; at the start this is everything."""

    def publish_clock(self) -> None:
        """Publish the time again at which the simulation stands still, for nodes that have started meanwhile."""

    def tick_ended(self, report: TickReport) -> None:
        """In lockstep, a control tick has ended."""

    def report(self) -> None:
        """Publish what is due by the wall clock; called often."""


class RunningSimulator:
    """The thread that calls run() owns the simulator: other threads only post jobs, which it runs between two steps."""

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

    def run(self, outputs: Outputs) -> None:
        """Simulate until stopped: clock ticks wait for the wall clock, lockstep control ticks for the controllers."""
        simulator, time, controllers = self.simulator, self.time_control, self.controllers
        time.pacer.restart(simulator.steps)
        simulator.changes = set(Change)
        self._pace(outputs)
        subscriptions = outputs.subscriptions()
        while not self._stopped():
            due = simulator.advance(subscriptions, time.steps_left(simulator.steps))
            if due is not None:
                outputs.publish(due, time.as_fast_as_possible and not due.control)
                if due.control and controllers.in_lockstep:
                    controllers.begin_tick(outputs.connected)
                    self._hold(lambda: controllers.hold_time(outputs.connected), outputs)
                    outputs.tick_ended(controllers.end_tick())
            if time.end_span(simulator.steps) or (due is not None and due.clock):
                self._pace(outputs)
                outputs.report()
                subscriptions = outputs.subscriptions()

    def _pace(self, outputs: Outputs) -> None:
        """Run the jobs that have come, and hold simulated time until the wall clock has reached it."""
        time, simulator = self.time_control, self.simulator
        self._run_jobs(outputs)
        wait = time.hold_time(simulator.steps)
        if 0.0 < wait < MAX_SLEEP:  # jobs that come meanwhile take effect from the next step on, as if they ran at once
            self._clock.sleep(wait)
            time.pacer.waited(wait)
            self._run_jobs(outputs)
            wait = time.hold_time(simulator.steps)
        if wait > 0.0:
            self._hold(lambda: time.hold_time(simulator.steps), outputs)

    def _run_jobs(self, outputs: Outputs) -> None:
        self.jobs.run_queued()
        self._publish_changes(outputs)

    def _publish_changes(self, outputs: Outputs) -> None:
        changes = self.simulator.changes
        if changes:  # there are none in nearly all rounds of the loop
            self.simulator.changes = set()
            if Change.RESET in changes:
                self.time_control.pacer.restart(self.simulator.steps)
            outputs.publish_changes(changes)

    def _hold(self, hold: Callable[[], float], outputs: Outputs) -> None:
        """Run the jobs of other threads for as long as `hold` says that simulated time has to wait [s, wall]."""
        pacer = self.time_control.pacer
        started, wait = pacer.now(), hold()
        while wait > 0.0 and not self._stopped():
            self.jobs.run_next(wait)
            self._publish_changes(outputs)
            if self.time_control.repetition_due():
                outputs.publish_clock()
            outputs.report()
            wait = hold()
        pacer.waited(pacer.now() - started)
