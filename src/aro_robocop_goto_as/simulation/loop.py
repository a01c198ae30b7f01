"""The simulation loop: steps the simulator, paces it, runs other threads' jobs, and keeps controllers in lockstep.

One thread calls `run` (or `advance`) and all other methods except `post` and `call`, which any thread may use.
"""

import contextlib
import queue
from concurrent.futures import Future, TimeoutError
from typing import AbstractSet, Callable, Dict, List, NamedTuple, Optional, Sequence, TypeVar

from ..component_params import LockstepParams, TimeParams
from ..errors import CommandError, RobocopError, ShutdownError
from ..geometry import STANDSTILL, Pose2D, Twist2D
from ..world.model import World
from .lockstep import Controller, Lockstep
from .observations import Observations, Subscriptions
from .pacer import Pacer
from .simulator import Simulator
from .wall_clock import Clock, Job, Jobs, WallClock

PAUSED_CLOCK_PERIOD = 0.1  # [s, wall] between repetitions of /clock while paused, for nodes that start meanwhile
LONGEST_WAIT = 0.5  # [s, wall] between two status reports while the loop waits for the wall clock
DISCONNECT_POLL = 0.05  # [s, wall] between two looks for disconnected controllers while waiting for their answers
CALL_POLL = 0.1  # [s, wall] between two looks for a shutdown while another thread waits for its job

T = TypeVar("T")


class _Pending(NamedTuple):
    controller: Controller
    twist: Twist2D


class LoopInterface:
    """What connects the loop to the outside: the ROS node, the judge, or a test. Called from the loop's thread."""

    def stopped(self) -> bool:
        """Whether the loop has to end."""
        return False

    def subscriptions(self) -> Subscriptions:
        """The sensors that somebody subscribes to now."""
        return {}

    def publish(self, observations: Observations) -> None:
        """Send one step's observations, and the clock last."""

    def publish_clock(self) -> None:
        """Repeat the clock while simulated time is held."""

    def report(self) -> None:
        """Called at clock ticks and while waiting: report the status if it is due."""

    def status_changed(self) -> None:
        """Paused, resumed or reset: report the status now."""

    def frames_changed(self) -> None:
        """map -> odom of a robot has jumped."""

    def world_changed(self) -> None:
        """The world was replaced by another one."""

    def connected(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that are connected to a robot's inputs."""
        return set()

    def answering(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that will answer a robot's control ticks."""
        return set()

    def command_refused(self, error: CommandError) -> None:
        """A velocity command was not finite; the previous one stays in force."""

    def controllers_late(self, controllers: Sequence[Controller]) -> None:
        """These did not answer a control tick in time; simulated time continues without them."""

    def controller_gone(self, controller: Controller) -> None:
        """This controller disconnected; its robot is stopped."""

    def placed_in_contact(self, robot: int) -> None:
        """A robot was placed in contact with an obstacle or with another robot."""


class SimulationLoop:
    """Owns the simulator, the pacer and the lockstep bookkeeping."""

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
        self._control_rate = lockstep.control_rate
        self.lockstep_timeout = lockstep.timeout
        self.in_lockstep = lockstep.enabled
        self.lockstep: Lockstep[Controller] = Lockstep()
        self._interface = interface
        self._clock = clock or WallClock()
        self.pacer = Pacer(time.real_time_factor, self._clock.now)
        self._jobs: Jobs[Job] = queue.Queue()
        self._span_end = 0  # step at which a requested span ends; 0 = none
        self._on_span_end: Callable[[], object] = lambda: None
        self._pause_after_span = True
        self._newly_placed = set(range(len(simulator.robots)))  # since the last clock tick
        self._pending: Dict[int, _Pending] = {}  # lockstep: newest command of each robot, applied at the tick's end
        self._resets = 0

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
            if observations is not None and observations.control and self.in_lockstep:
                self._wait_for_controllers()
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
                self._enroll_answering()
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

    # -- velocity commands --

    def command(self, controller: Controller, twist: Twist2D) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick."""
        if self.lockstep.is_stamped(controller):
            return  # this controller sends the same command with its answer
        if not self.in_lockstep:
            self._apply(controller.robot, twist)
            return
        self.lockstep.tick = self.tick
        self.lockstep.commanded(controller)
        self._pending[controller.robot] = _Pending(controller, twist)

    def answer(self, controller: Controller, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        tick = round(stamp_ns * self._control_rate / 1e9)
        if tick > self.tick:
            return  # sent before a reset set simulated time back
        self.lockstep.answered(controller, tick)
        if twist is not None:
            self._pending[controller.robot] = _Pending(controller, twist)

    def _apply(self, robot: int, twist: Twist2D) -> None:
        try:
            self.simulator.command(twist, robot)
        except CommandError as error:
            self._interface.command_refused(error)

    @property
    def tick(self) -> int:
        """Number of the control tick at which simulated time stands, or which it runs towards."""
        return -(-self.simulator.steps * self._control_rate // self.simulator.config.rates.physics)

    def _wait_for_controllers(self) -> None:
        """Hold simulated time until every controller has answered this tick or timed out, then apply the commands."""
        self._enroll_answering()
        self.lockstep.tick = self.tick
        started, resets = self._clock.now(), self._resets
        next_look = started + DISCONNECT_POLL
        while self.lockstep.missing() and self._resets == resets and not self._interface.stopped():
            now = self._clock.now()
            remaining = started + self.lockstep.patience() * self.lockstep_timeout - now
            if remaining <= 0.0:
                late = self.lockstep.give_up()
                if late:
                    self._interface.controllers_late(late)
                break
            if now >= next_look:
                self._forget_disconnected()
                next_look = now + DISCONNECT_POLL
                continue
            with contextlib.suppress(queue.Empty):
                self._clock.get(self._jobs, min(remaining, next_look - now))()
        self.pacer.waited(self._clock.now() - started)
        pending, self._pending = self._pending, {}
        for robot, command in pending.items():
            self._apply(robot, command.twist)

    def _enroll_answering(self) -> None:
        """Controllers that are connected to answer ticks are waited for from their first tick on."""
        if self.in_lockstep:
            for robot in range(len(self.simulator.robots)):
                for node in self._interface.answering(robot):
                    self.lockstep.enroll(Controller(robot, node))

    def _forget_disconnected(self) -> None:
        """Do not wait for a controller that has disconnected, and stop its robot."""
        for controller in self.lockstep.missing():
            if controller.node not in self._interface.connected(controller.robot):
                self._interface.controller_gone(controller)
                self.lockstep.gone(controller)
                pending = self._pending.get(controller.robot)
                if pending is None or pending.controller == controller:
                    self._pending[controller.robot] = _Pending(controller, STANDSTILL)

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
        self._resets += 1
        self._pending.clear()
        self._newly_placed.update(range(len(self.simulator.robots)))
        self.lockstep.restart(self.tick)
        self.pacer.restart(self.simulator.time)
        if self._reset_time:
            self._interface.publish_clock()
        self._interface.frames_changed()
        self._interface.status_changed()

    def place(self, world_from_footprint: Pose2D, robot: int = 0) -> None:
        """Place a robot elsewhere, at rest."""
        self.simulator.place(world_from_footprint, robot)
        self._pending.pop(robot, None)
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

    def drivers(self) -> List[Controller]:
        """The controllers that lockstep waits for; empty without lockstep."""
        return self.lockstep.drivers() if self.in_lockstep else []
