"""Simulator status topics: ~status, ~real_time_factor, /diagnostics."""

import time
from typing import List, Sequence

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Float64, Header

from aro_robocop_goto_as.msg import SimStatus

from ...robot.model import RobotSpec
from ...simulation.lockstep import ControllerId
from ...simulation.simulation import Simulation
from ...simulation.time_control import FactorReport
from .. import convert
from ..names import SIMULATOR
from ..publishing import publisher


def controller_name(controller: ControllerId, robots: Sequence[RobotSpec]) -> str:
    """How messages name a controller: by its node, and among several robots also by the one that it commands."""
    return f"{controller.node} driving {robots[controller.robot].name}" if len(robots) > 1 else controller.node


class StatusTopics:
    """One report per second of wall time, and one whenever the set of controllers changes."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._report = FactorReport(0.0, simulation.time_control.pacer.factor, 0.0, 0.0)
        self._running = 0  # reports while simulated time ran
        self._behind: List[float] = []  # the factors reached in those in which the machine was too slow
        self._awaited: List[ControllerId] = []
        self._factor = publisher("~real_time_factor", Float64, latch=True)
        self._status = publisher("~status", SimStatus, latch=True)
        self._diagnostics = publisher("/diagnostics", DiagnosticArray)

    def report(self) -> bool:
        """Publish what is due; cheap when nothing is. Returns whether a second has passed."""
        simulator = self._simulation.simulator
        report = self._simulation.time_control.pacer.report(simulator.steps)
        if report is not None:
            self._report = report
            self._factor.publish(report.reached)
            self.publish()
            if not self._simulation.time_control.paused:
                self._count(report)
        elif self._simulation.controllers.awaited() != self._awaited:
            self.publish()
        return report is not None

    def _count(self, report: FactorReport) -> None:
        """Warn the first time that the machine is too slow; the summary at the end says how often it was."""
        self._running += 1
        if not report.behind:
            return
        self._behind.append(report.reached)
        if len(self._behind) == 1:
            text = (
                "real-time factor %.2f achieved, %.2f requested: this machine is too slow; simulated time runs slower, "
            )
            rospy.logwarn(text + "results are the same; a summary follows at the end", report.reached, report.asked)
            rospy.on_shutdown(self._summarize)

    def _summarize(self) -> None:
        mean, slowest = sum(self._behind) / len(self._behind), min(self._behind)
        text = "the machine was too slow in %d of %d s: real-time factor %.2f on average then, %.2f at the slowest"
        rospy.logwarn(text, len(self._behind), self._running, mean, slowest)

    def publish(self) -> None:
        """Publish the newest report now."""
        simulation, simulator, report = self._simulation, self._simulation.simulator, self._report
        self._awaited = simulation.controllers.awaited()
        self._status.publish(
            SimStatus(
                stamp=convert.to_time(simulator.stamp_ns),
                world=simulator.world.name,
                robots=[robot.name for robot in simulator.robots],
                seed=simulator.seed,
                drive=simulator.p.engine.drive,
                sync=self._sync,
                paused=simulation.time_control.paused,
                factor_asked=simulation.time_control.pacer.factor,
                factor_reached=report.reached,
                step_time=report.step_time,
                behind=report.lag,
                drivers=sorted(controller_name(controller, simulator.robots) for controller in self._awaited),
                lockstep_misses=simulation.controllers.lockstep.misses,
            )
        )
        if self._diagnostics.get_num_connections():
            self._diagnostics.publish(self._diagnostic_array())

    @property
    def _sync(self) -> str:
        return "lockstep" if self._simulation.controllers.in_lockstep else "free"

    def _diagnostic_array(self) -> DiagnosticArray:
        simulation, simulator, report = self._simulation, self._simulation.simulator, self._report
        level, text = DiagnosticStatus.OK, "paused" if simulation.time_control.paused else "running"
        if report.behind and not simulation.time_control.paused:
            level, text = DiagnosticStatus.WARN, "slower than the requested real-time factor"
        values = {
            "world": simulator.world.name,
            "robots": len(simulator.robots),
            "seed": simulator.seed,
            "drive": simulator.p.engine.drive,
            "sync": self._sync,
            "real-time factor asked": simulation.time_control.pacer.factor,
            "real-time factor reached": round(report.reached, 3),
            "step time [s]": report.step_time,
            "behind [s]": report.lag,
            "lockstep misses": simulation.controllers.lockstep.misses,
        }
        status = DiagnosticStatus(
            level,
            f"{SIMULATOR}: simulation",
            text,
            SIMULATOR,
            [KeyValue(key, str(value)) for key, value in values.items()],
        )
        return DiagnosticArray(Header(0, rospy.Time.from_sec(time.time()), ""), [status])
