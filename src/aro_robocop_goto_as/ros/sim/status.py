"""Simulator status topics ~status, ~real_time_factor, and warnings about the machine and controllers."""

import math
from typing import List, Set

import rospy
from std_msgs.msg import Float64

from aro_robocop_goto_as.msg import SimStatus

from ...geometry import Pose2D, compose
from ...names import SIMULATOR, absolute, robocop
from ...simulation.lockstep import ControllerId, TickOutcome
from ...simulation.running import RunningSimulator
from ...simulation.simulator import Simulator
from ...simulation.time_control import Pace
from .. import convert
from ..publishing.publisher import publisher


class StatusTopics:
    """Published once per second of wall time, and whenever the set of controllers changes."""

    def __init__(self, running: RunningSimulator) -> None:
        self._running = running
        self._pace = Pace(0.0, running.time_control.pacer.factor, 0.0, 0.0)
        self._has_warned_of_lag = False
        self._drivers: List[ControllerId] = []
        self._slipped: Set[int] = set()  # robots
        self._factor = publisher("~real_time_factor", Float64, latch=True)
        self._status = publisher("~status", SimStatus, latch=True)

    def publish_due(self) -> bool:
        """Publish what is due; cheap when nothing is. Returns whether a second has passed."""
        simulator = self._running.simulator
        pace = self._running.time_control.pacer.measure_pace(simulator.steps)
        if pace is not None:
            self._pace = pace
            self._factor.publish(pace.reached)
            self._watch_slip()
            self.publish()
            self._warn_of_lag(pace)
        elif self._running.controllers.lockstep.expected() != self._drivers:
            self.publish()
        return pace is not None

    def _warn_of_lag(self, pace: Pace) -> None:
        """Warn the first time that the machine is too slow; ~status and ~real_time_factor have what follows."""
        if self._has_warned_of_lag or self._running.time_control.paused or not pace.behind:
            return
        self._has_warned_of_lag = True
        text = "real-time factor %.2f achieved, %.2f requested: this machine is too slow; simulated time runs slower"
        rospy.logwarn(text, pace.reached, pace.asked)

    def _watch_slip(self) -> None:
        """Note robots whose wheels turned at an obstacle until odometry was off by their radius, and warn once of each.

        Only where map -> odom is static, as nothing corrects odometry then, and no errors of odometry are set.
        """
        simulator = self._running.simulator
        odometry = simulator.params.sensors.odometry
        has_errors = odometry.odom_wheel_radius_error or odometry.odom_slip
        if has_errors or simulator.params.topics.localization != "static":
            return
        for index, robot in enumerate(simulator.robots):
            error = odometry_error(simulator, index)
            if error <= robot.model.figures.footprint_radius:
                self._slipped.discard(index)
            elif index not in self._slipped and simulator.touching(index):
                self._slipped.add(index)
                rospy.logwarn(
                    "the wheels %sslipped at an obstacle: odometry is %.2f m off; this puts robots and odometry back: "
                    "%s shell rosservice call %s 0",
                    robot.name and f"of {robot.name} ",
                    error,
                    robocop(),
                    absolute(SIMULATOR, "reset"),
                )

    def warn_of(self, outcome: TickOutcome) -> None:
        """Log what went wrong in a control tick in lockstep."""
        for controller in outcome.gone:
            rospy.logwarn("lockstep: %s disconnected; the robot is stopped", self._name(controller))
        for controller in outcome.late:
            text = "lockstep: no answer from %s within %g s; it is waited for again once it answers at each tick"
            rospy.logwarn(text, self._name(controller), self._running.controllers.lockstep.timeout)

    def _name(self, controller: ControllerId) -> str:
        """A controller's name in messages: its node, and among several robots also the robot that it commands."""
        robots = self._running.simulator.robots
        return f"{controller.node} driving {robots[controller.robot].name}" if len(robots) > 1 else controller.node

    def publish(self) -> None:
        """Publish ~status now."""
        running, simulator, pace = self._running, self._running.simulator, self._pace
        self._drivers = running.controllers.lockstep.expected()
        status = SimStatus(
            stamp=convert.to_time(simulator.stamp_ns),
            world=simulator.world.name,
            robots=[robot.name for robot in simulator.robots],
            slipped=[simulator.robots[index].name for index in sorted(self._slipped)],
            seed=simulator.seed,
            drive=simulator.params.engine.drive,
            sync="lockstep" if running.controllers.in_lockstep else "free",
            paused=running.time_control.paused,
            factor_asked=running.time_control.pacer.factor,
            factor_reached=pace.reached,
            step_time=pace.step_time,
            behind=pace.lag,
            drivers=sorted(map(self._name, self._drivers)),
            lockstep_misses=running.controllers.lockstep.misses,
        )
        self._status.publish(status)


def odometry_error(simulator: Simulator, robot: int) -> float:
    """How far [m] a robot is from where its newest odometry, with map -> odom, says that it is."""
    odom_from_footprint = Pose2D(*simulator.sensors.odometry.poses[robot].tolist())
    believed, true = compose(simulator.map_from_odom(robot), odom_from_footprint), simulator.world_from_footprint(robot)
    return math.hypot(believed.x - true.x, believed.y - true.y)
