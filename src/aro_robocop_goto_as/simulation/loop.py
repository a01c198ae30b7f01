"""The simulation loop: steps the simulator, paces it, runs other threads' jobs, and waits for the controllers.

One thread calls `run` (or `advance`) and all other methods except `post` and `call`, which any thread may use.
"""

import contextlib
import queue
from concurrent.futures import Future, TimeoutError
from typing import Callable, Optional, TypeVar

from ..component_params import LockstepParams, TimeParams
from ..errors import RobocopError, ShutdownError
from ..geometry import Pose2D
from ..world.model import World
from .controllers import Controllers
from .loop_interface import LoopInterface
from .observations import Observations, Subscriptions
from .pacer import Pacer
from .simulator import Simulator
from .wall_clock import Clock, Job, Jobs, WallClock

PAUSED_CLOCK_PERIOD = 0.1  # [s, wall] between repetitions of /clock while paused, for nodes that start meanwhile
LONGEST_WAIT = 0.5  # [s, wall] between two status reports while the loop waits for the wall clock
CALL_POLL = 0.1  # [s, wall] between two looks for a shutdown while another thread waits for its job

T = TypeVar("T")


class SimulationLoop:
    """Owns the simulator, the pacer and the controllers."""

    def __init__(
        self,
        simulator: Simulator,
        time: TimeParams,
        lockstep: LockstepParams,
        interface: LoopInterface,
        clock: Optional[Clock] = None,
    ) -> None:
        self.simulator = simulator
        self.paused = time.start_paused
        self._reset_time = time.reset_time
        self._interface = interface
        self._clock = clock or WallClock()
        self.pacer = Pacer(time.real_time_factor, self._clock.now)
        self._jobs: Jobs[Job] = queue.Queue()
        self.controllers = Controllers(simulator, lockstep, interface, self._clock, self._jobs)
        self._span_end = 0  # step at which a requested span ends; 0 = none
        self._on_span_end: Callable[[], object] = lambda: None
        self._pause_after_span = True
        self._newly_placed = set(range(len(simulator.robots)))  # since the last clock tick

    # -- called by other threads --

    def post(self, job: Job) -> None:
        """Have the loop's thread run a job between two steps."""
        self._jobs.put(job)

    def call(self, function: Callable[[], T]) -> T:
        """Run a function in the loop's thread; returns what it returns, raises the RobocopError that it raises.

        Any other exception is a programming error and ends the loop.
        """
        future: Future[T] = Future()

        def job() -> None:
            try:
                future.set_result(function())
            except RobocopError as error:
                future.set_exception(error)

        self.post(job)
        return self.wait_for(future)

    def wait_for(self, future: "Future[T]") -> T:
        """The result that the loop's thread sets; ShutdownError when the loop has ended instead."""
        while not self._interface.stopped():
            with contextlib.suppress(TimeoutError):
                return future.result(timeout=CALL_POLL)
        raise ShutdownError("the simulator is shutting down")

    # -- the loop --

    def run(self) -> None:
        """Step until stopped. Clock ticks wait for the wall clock, lockstep control ticks for the controllers."""
        self.pacer.restart(self.simulator.time)
        self._run_jobs()
        subscriptions = self._interface.subscriptions()
        while not self._interface.stopped():
            observations = self.advance(subscriptions)
            if observations is not None and observations.control and self.controllers.in_lockstep:
                self.pacer.waited(self.controllers.await_answers())
            if self._span_end and self.simulator.steps >= self._span_end:
                self._finish_span()
            elif observations is not None and observations.clock:
                self._report_contacts()
            else:
                continue
            self._run_jobs()
            self._interface.report()
            subscriptions = self._interface.subscriptions()

    def advance(self, subscriptions: Subscriptions) -> Optional[Observations]:
        """One step, published."""
        observations = self.simulator.step(subscriptions)
        if observations is not None:
            self._interface.publish(observations)
        return observations

    def _run_jobs(self) -> None:
        """Run jobs until the wall clock reaches simulated time; while paused, until simulated time may go on."""
        repeat_clock = self._clock.now() + PAUSED_CLOCK_PERIOD
        while not self._interface.stopped():
            standing = self.paused and not self._span_end
            wait = PAUSED_CLOCK_PERIOD if standing else min(LONGEST_WAIT, self.pacer.ahead(self.simulator.time))
            if wait <= 0.0 and self._jobs.empty():
                return
            started = self._clock.now()
            if standing and started >= repeat_clock:
                repeat_clock = started + PAUSED_CLOCK_PERIOD
                self._interface.publish_clock()
                self.controllers.enroll_answering()
                self._interface.report()
            try:
                job = self._clock.get(self._jobs, wait)
            except queue.Empty:
                if not standing and wait < LONGEST_WAIT:
                    return
                self._interface.report()
                continue
            finally:
                self.pacer.waited(self._clock.now() - started)
            job()

    def run_jobs_until(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Run jobs until a condition holds, for `timeout` [s, wall] at most; whether it holds.

        Then also runs the jobs that are already queued, and no more: their senders may be faster than the loop.
        """
        deadline = self._clock.now() + timeout
        while not condition():
            remaining = deadline - self._clock.now()
            try:
                self._clock.get(self._jobs, max(1e-6, remaining))()
            except queue.Empty:
                return condition()
            if self._clock.now() >= deadline:
                break
        for _ in range(self._jobs.qsize()):
            self._jobs.get_nowait()()
        return condition()

    @property
    def jobs_waiting(self) -> int:
        """How many jobs have not been run yet."""
        return self._jobs.qsize()

    def _report_contacts(self) -> None:
        """Report robots that were placed in contact: physics pushes them out, or they cannot move."""
        for robot in sorted(self._newly_placed):
            if self.simulator.touching(robot):
                self._interface.placed_in_contact(robot)
        self._newly_placed.clear()

    # -- simulated time --

    def set_paused(self, paused: bool) -> None:
        """Pause or resume simulated time; during a span, from its end on."""
        self.paused = self._pause_after_span = paused
        self.pacer.restart(self.simulator.time)
        self._interface.status_changed()

    def begin_span(self, duration: float, on_end: Callable[[], object]) -> bool:
        """Run for `duration` [s, simulated], one step at least, then pause and call `on_end`; False while one runs.

        If somebody resumes the simulation meanwhile, it keeps running instead.
        """
        if self._span_end:
            return False
        self._pause_after_span = True
        steps = max(1, round(duration * self.simulator.config.rates.physics))
        self._span_end, self._on_span_end = self.simulator.steps + steps, on_end
        self.pacer.restart(self.simulator.time)
        return True

    def _finish_span(self) -> None:
        self._span_end, self.paused = 0, self._pause_after_span
        self._on_span_end()

    def set_real_time_factor(self, factor: float) -> None:
        """Run at this multiple of the wall clock from now on; 0 = as fast as possible."""
        self.pacer.factor = factor
        self.pacer.restart(self.simulator.time)

    # -- changes of the world --

    def reset(self, seed: Optional[int] = None) -> None:
        """Robots to their spawn poses, odometry to zero, noise to its start; None keeps the seed."""
        before = self.simulator.steps
        self.simulator.reset(seed, restart_time=self._reset_time)
        if self._span_end:
            self._span_end -= before - self.simulator.steps
        self._newly_placed.update(range(len(self.simulator.robots)))
        self.controllers.restart()
        self.pacer.restart(self.simulator.time)
        if self._reset_time:
            self._interface.publish_clock()
        self._interface.frames_changed()
        self._interface.status_changed()

    def place(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Place a robot elsewhere, at rest."""
        self.simulator.place(world_from_footprint, robot)
        self.controllers.drop_command(robot)
        self._newly_placed.add(robot)
        self._interface.frames_changed()

    def place_with_room(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Like place(), but raises PlaceError, naming the obstacle, if the robot would overlap something."""
        self.simulator.require_room(world_from_footprint, robot)
        self.place(world_from_footprint, robot)

    def change_world(self, edit: Callable[[World], World]) -> None:
        """Replace the world by what `edit` makes of it."""
        self.simulator.change_world(edit(self.simulator.world))
        self._newly_placed.update(range(len(self.simulator.robots)))
        self._interface.world_changed()
