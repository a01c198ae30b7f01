"""How fast and for whom the simulator runs: ~status, ~real_time_factor, /diagnostics."""

import time
from typing import List, Sequence

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Float64, Header

from aro_robocop_goto_as.msg import SimStatus

from ...robot.model import RobotSpec
from ...simulation.lockstep import Controller
from ...simulation.loop import SimulationLoop
from ...simulation.pacer import FactorReport
from .. import convert
from ..publishing import publisher


def controller_name(controller: Controller, robots: Sequence[RobotSpec]) -> str:
    """A controller for people: its node, and among several robots the one that it commands."""
    return f"{controller.node} driving {robots[controller.robot].name}" if len(robots) > 1 else controller.node


class StatusTopics:
    """One report per second of wall time, and one whenever the set of controllers changes."""

    def __init__(self, loop: SimulationLoop, engine_kind: str) -> None:
        self._loop = loop
        self._engine_kind = engine_kind
        self._report = FactorReport(0.0, loop.pacer.factor, 0.0, 0.0)
        self._drivers: List[Controller] = []
        self._factor = publisher("~real_time_factor", Float64, latch=True)
        self._status = publisher("~status", SimStatus, latch=True)
        self._diagnostics = publisher("/diagnostics", DiagnosticArray)

    def report(self) -> None:
        """Publish what is due; cheap when nothing is."""
        simulator = self._loop.simulator
        report = self._loop.pacer.report(simulator.time, simulator.steps)
        if report is not None:
            self._report = report
            self._factor.publish(report.reached)
            self.publish()
            if report.behind and not self._loop.paused:
                rospy.logwarn_throttle(
                    10.0,
                    "real-time factor %.2f achieved, %.2f requested: this machine is too slow; simulated time runs "
                    "slower, results are the same",
                    report.reached,
                    report.asked,
                )
        elif self._loop.controllers.awaited() != self._drivers:
            self.publish()

    def publish(self) -> None:
        """Publish the newest report now."""
        loop, simulator, report = self._loop, self._loop.simulator, self._report
        self._drivers = loop.controllers.awaited()
        self._status.publish(
            SimStatus(
                stamp=convert.to_time(simulator.stamp_ns),
                world=simulator.world.name,
                robots=[robot.name for robot in simulator.robots],
                seed=simulator.seed,
                drive=self._engine_kind,
                sync=self._sync,
                paused=loop.paused,
                factor_asked=loop.pacer.factor,
                factor_reached=report.reached,
                step_time=report.step_time,
                behind=report.lag,
                drivers=sorted(controller_name(driver, simulator.robots) for driver in self._drivers),
                lockstep_misses=loop.controllers.lockstep.misses,
            )
        )
        if self._diagnostics.get_num_connections():
            self._diagnostics.publish(self._diagnostic_array())

    @property
    def _sync(self) -> str:
        return "lockstep" if self._loop.controllers.in_lockstep else "free"

    def _diagnostic_array(self) -> DiagnosticArray:
        loop, simulator, report = self._loop, self._loop.simulator, self._report
        level, text = DiagnosticStatus.OK, "paused" if loop.paused else "running"
        if report.behind and not loop.paused:
            level, text = DiagnosticStatus.WARN, "slower than the requested real-time factor"
        values = {
            "world": simulator.world.name,
            "robots": len(simulator.robots),
            "seed": simulator.seed,
            "drive": self._engine_kind,
            "sync": self._sync,
            "real-time factor asked": loop.pacer.factor,
            "real-time factor reached": round(report.reached, 3),
            "step time [s]": report.step_time,
            "behind [s]": report.lag,
            "lockstep misses": loop.controllers.lockstep.misses,
        }
        status = DiagnosticStatus(
            level,
            "robocop_sim: simulation",
            text,
            "robocop_sim",
            [KeyValue(key, str(value)) for key, value in values.items()],
        )
        return DiagnosticArray(Header(0, rospy.Time.from_sec(time.time()), ""), [status])
