"""What a simulator in lockstep says of controllers that did not answer a control tick."""

import rospy

from ...simulation.controllers import TickReport
from ...simulation.simulator import Simulator
from .status import controller_name


def warn_of(report: TickReport, simulator: Simulator, timeout: float) -> None:
    """Log how a tick ended; timeout [s, wall]: how long it waited for an answer that was due."""
    robots, control_rate = simulator.robots, simulator.p.rates.control_rate
    for controller in report.gone:
        rospy.logwarn("lockstep: %s disconnected; the robot is stopped", controller_name(controller, robots))
    if report.late:
        names = ", ".join(controller_name(controller, robots) for controller in report.late)
        rospy.logwarn(f"lockstep: no answer from {names} within {timeout:g} s; simulated time continues without it")
    for controller, rate in report.slower:
        name = controller_name(controller, robots)
        text = "lockstep: %s runs at %g Hz, control_rate is %g Hz: it is waited for only at its own ticks from now on"
        rospy.logwarn(text, name, rate, control_rate)
