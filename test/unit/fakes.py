"""A wall clock that advances only while somebody waits, and an owner of a simulation without ROS."""

import queue
from typing import AbstractSet, Callable, List, Set, Tuple

from support import ORIGIN, model_named, world_named

from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.agenda import Due
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.jobs import Clock, Job, Queue
from aro_robocop_goto_as.simulation.lockstep import ControllerId
from aro_robocop_goto_as.simulation.running import Simulation


class FakeClock(Clock):
    """Waiting takes no real time; actions may be scheduled at a time [s] of this clock."""

    def __init__(self) -> None:
        self.time = 100.0
        self._scheduled: List[Tuple[float, Callable[[], object]]] = []

    def at(self, delay: float, action: Callable[[], object]) -> None:
        """Schedule an action, such as posting a job, after a delay [s]."""
        self._scheduled.append((self.time + delay, action))
        self._scheduled.sort(key=lambda entry: entry[0])

    def now(self) -> float:
        return self.time

    def get(self, jobs: "Queue[Job]", timeout: float) -> Job:
        deadline = self.time + max(0.0, timeout)
        while jobs.empty():
            if not self._scheduled or self._scheduled[0][0] > deadline:
                self.time = deadline
                raise queue.Empty
            self.time, action = self._scheduled.pop(0)
            action()
        return jobs.get_nowait()


class Owner:
    """Runs one robot in the empty world with the loop of ros/sim/node.py, by a fake clock."""

    def __init__(self, end: float = 1.0, **params: object) -> None:
        """Stops at a simulated time [s]; `params` are the simulator's."""
        p = SimParams.of(drive="kinematic", cmd_vel_timeout=0.0, **params)
        self.simulator = make_simulator(p, world_named("empty"), [RobotSpec("", model_named("burger"), ORIGIN)])
        self.clock, self.end = FakeClock(), end
        self.nodes: Set[str] = set()  # that are connected to the robot's topics
        self.seen: List[Tuple[int, Due]] = []  # stamp [ns] and what was due
        self.events: List[object] = []
        self.on_tick: Callable[[int], object] = lambda stamp_ns: None  # called at each control tick
        self.is_stopped: Callable[[], bool] = lambda: self.simulator.time >= self.end
        self.simulation = Simulation(self.simulator, self.clock, lambda: self.is_stopped())

    def post(self, delay: float, job: Job) -> None:
        """Have another thread post a job after a delay [s, wall]."""
        self.clock.at(delay, lambda: self.simulation.jobs.post(job))

    def run(self) -> None:
        simulator, time, controllers = self.simulator, self.simulation.time_control, self.simulation.controllers
        time.pacer.restart(simulator.steps)
        self._pace()
        while not self.is_stopped():
            due = simulator.advance({"odom": [0]}, time.steps_left(simulator.steps))
            if due is not None:
                self.seen.append((simulator.stamp_ns, due))
                if due.control:
                    self.on_tick(simulator.stamp_ns)
                if due.control and controllers.in_lockstep:
                    controllers.begin_tick(self._connected)
                    self._hold(lambda: controllers.hold(self._connected))
                    report = controllers.end_tick()
                    self.events += [("late", report.late)] if report.late else []
                    self.events += [("gone", controller) for controller in report.gone]
            if time.end_span(simulator.steps) or (due is not None and due.clock):
                self._pace()

    def _pace(self) -> None:
        self.simulation.jobs.run_queued()
        self._hold(lambda: self.simulation.time_control.hold(self.simulator.steps))

    def _hold(self, hold: Callable[[], float]) -> None:
        started = self.clock.now()
        wait = hold()
        while wait > 0.0 and not self.is_stopped():
            self.simulation.jobs.run_next(wait)
            if self.simulation.time_control.repetition_due():
                self.events.append("clock repeated")
            wait = hold()
        self.simulation.time_control.pacer.waited(self.clock.now() - started)

    def _connected(self) -> AbstractSet[ControllerId]:
        return {ControllerId(0, node) for node in self.nodes}
