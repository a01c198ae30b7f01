"""A wall clock that advances only while somebody waits, and the owner of a running simulator without ROS."""

import queue

from support import ORIGIN, model_named, world_named

from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.jobs import WallClock
from aro_robocop_goto_as.simulation.lockstep import ControllerId
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.simulation.running import RunningSimulator
from aro_robocop_goto_as.simulation.simulator import Change


class FakeClock(WallClock):
    """Waiting takes no real time; actions may be scheduled at a time [s] of this clock."""

    def __init__(self):
        self.time = 100.0
        self._scheduled = []

    def at(self, delay, action):
        """Schedule an action, such as posting a job, after a delay [s]."""
        self._scheduled.append((self.time + delay, action))
        self._scheduled.sort(key=lambda entry: entry[0])

    def now(self):
        return self.time

    def sleep(self, seconds):
        deadline = self.time + seconds
        while self._scheduled and self._scheduled[0][0] <= deadline:
            self.time, action = self._scheduled.pop(0)
            action()
        self.time = deadline

    def get(self, jobs, timeout):
        deadline = self.time + max(0.0, timeout)
        while jobs.empty():
            if not self._scheduled or self._scheduled[0][0] > deadline:
                self.time = deadline
                raise queue.Empty
            self.time, action = self._scheduled.pop(0)
            action()
        return jobs.get_nowait()


class Owner:
    """Runs one robot in the empty world without ROS, by a fake clock, and notes what is published."""

    def __init__(self, end=1.0, **params):
        """Stops at a simulated time [s]; `params` are the simulator's."""
        p = SimParams.of(drive="kinematic", cmd_vel_timeout=0.0, **params)
        self.simulator = make_simulator(p, world_named("empty"), [RobotSpec("", model_named("burger"), ORIGIN)])
        self.clock, self.end = FakeClock(), end
        self.nodes = set()  # that are connected to the robot's topics
        self.seen = []  # stamp [ns] and what was due
        self.events = []
        self.on_tick = lambda stamp_ns: None  # called at each control tick
        self.is_stopped = lambda: self.simulator.time >= self.end
        self.running = RunningSimulator(self.simulator, self.clock, lambda: self.is_stopped())

    def post(self, delay, job):
        """Have another thread post a job after a delay [s, wall]."""
        self.clock.at(delay, lambda: self.running.jobs.post(job))

    def run(self):
        for now in self.running.rounds(lambda: {"odom": [0]}, self._connected):
            if now.due is not None:
                self.seen.append((self.simulator.stamp_ns, now.due))
                if now.due.control:
                    self.on_tick(self.simulator.stamp_ns)
            if now.changes and now.changes != set(Change):  # which are published at the start
                self.events.append(now.changes)
            if now.clock:
                self.events.append("clock repeated")
            if now.outcome is not None:
                self.events += [("late", now.outcome.late)] if now.outcome.late else []
                self.events += [("gone", controller) for controller in now.outcome.gone]

    def _connected(self):
        return {ControllerId(0, node) for node in self.nodes}
