"""What the simulator does and how well it keeps up: ~status, ~real_time_factor, /diagnostics."""

import time
from typing import TYPE_CHECKING, List, Optional

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Float64, Header

from aro_robocop_goto_as.msg import SimStatus

from . import convert
from .pacer import FactorReport
from .publishing import publisher

if TYPE_CHECKING:
    from .sim import SimNode

FACTOR_PARAMETER = "~real_time_factor"


class StatusReport:
    """One report a second of wall time, and one whenever the set of drivers changes."""

    def __init__(self, node: "SimNode") -> None:
        self.node = node
        self.report = FactorReport(0.0, node.pacer.factor, 0.0, 0.0)
        self.drivers: List[str] = []
        self.factor_parameter: Optional[object] = rospy.get_param_cached(FACTOR_PARAMETER, node.pacer.factor)
        self.factor = publisher("~real_time_factor", Float64, latch=True)
        self.status = publisher("~status", SimStatus, latch=True)
        self.diagnostics = publisher("/diagnostics", DiagnosticArray)

    def tick(self) -> None:
        """Called at each clock tick; cheap when there is nothing to say."""
        report = self.node.pacer.report(self.node.sim.time, self.node.sim.steps)
        if report is not None:
            self.report = report
            self._follow_parameter()
            self.factor.publish(report.reached)
            self.publish()
            if report.behind and not self.node.paused:
                rospy.logwarn_throttle(10.0, "real-time factor %.2f reached, %.2f asked for: this machine is too slow "
                                       "for it; simulated time is slower, results are the same", report.reached,
                                       report.asked)
        elif self.node.p.sync == "lockstep" and self.node.lockstep.drivers() != self.drivers:
            self.publish()

    def _follow_parameter(self) -> None:
        """`rosparam set` of the factor counts as much as dynamic_reconfigure."""
        value = rospy.get_param_cached(FACTOR_PARAMETER, self.node.pacer.factor)
        if value == self.factor_parameter:
            return
        self.factor_parameter = value
        if isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value < float("inf"):
            self.node.control.set_factor(float(value))
        else:
            rospy.logerr("%s: expected a number, 0 or more, got %r; it stays %g",
                         rospy.resolve_name(FACTOR_PARAMETER), value, self.node.pacer.factor)
            self.factor_parameter = self.node.pacer.factor
            rospy.set_param(FACTOR_PARAMETER, self.node.pacer.factor)

    def publish(self) -> None:
        """Send the newest report now."""
        node, report = self.node, self.report
        self.drivers = node.lockstep.drivers() if node.p.sync == "lockstep" else []
        self.status.publish(SimStatus(
            stamp=convert.to_time(node.sim.stamp_ns), world=node.sim.world.name,
            robots=[robot.name for robot in node.robots], seed=node.sim.seed, drive=node.p.drive, sync=node.p.sync,
            paused=node.paused, factor_asked=node.pacer.factor, factor_reached=report.reached,
            step_time=report.step_time, behind=report.lag, drivers=self.drivers,
            lockstep_misses=node.lockstep.misses))
        if self.diagnostics.get_num_connections():
            self.diagnostics.publish(self._diagnostics())

    def _diagnostics(self) -> DiagnosticArray:
        node, report = self.node, self.report
        level, text = DiagnosticStatus.OK, "paused" if node.paused else "running"
        if report.behind and not node.paused:
            level, text = DiagnosticStatus.WARN, "slower than asked"
        values = {"world": node.sim.world.name, "robots": len(node.robots), "seed": node.sim.seed,
                  "drive": node.p.drive, "sync": node.p.sync, "real-time factor asked": node.pacer.factor,
                  "real-time factor reached": round(report.reached, 3), "step time [s]": report.step_time,
                  "behind [s]": report.lag, "lockstep misses": node.lockstep.misses}
        status = DiagnosticStatus(level, "robocop_sim: simulation", text, "robocop_sim",
                                  [KeyValue(key, str(value)) for key, value in values.items()])
        return DiagnosticArray(Header(0, rospy.Time.from_sec(time.time()), ""), [status])
