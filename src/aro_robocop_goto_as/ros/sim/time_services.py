"""Services that control simulated time: pause, unpause, step, reset; and the real-time factor."""

import math
from typing import Any, Tuple

import rospy
from genpy import Time
from std_srvs.srv import Trigger

from aro_robocop_goto_as.srv import Reset, Step

from ...simulation.schedule import stamp_ns
from ...simulation.simulation import Simulation
from .. import convert
from ..reconfigure import Server, SimConfig

LONGEST_STEP = 1e6  # [s]


class TimeServices:
    """Every request is carried out in the owner's thread, between two steps."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        call = simulation.jobs.call
        rospy.Service("~pause", Trigger, lambda _: (True, call(lambda: self._set_paused(True))))
        rospy.Service("~unpause", Trigger, lambda _: (True, call(lambda: self._set_paused(False))))
        rospy.Service("~step", Step, self._on_step)
        rospy.Service("~reset", Reset, self._on_reset)
        rospy.set_param("~real_time_factor", simulation.time_control.pacer.factor)  # its server begins here
        self._reconfigure = Server(SimConfig, self._on_reconfigure)

    def set_factor(self, factor: float) -> None:
        """Change the real-time factor, as dynamic_reconfigure does, and tell its clients."""
        self._reconfigure.update_configuration({"real_time_factor": factor})

    def _set_paused(self, paused: bool) -> str:
        self._simulation.set_paused(paused)
        return "{} at {:.3f} s".format("paused" if paused else "running", self._simulation.simulator.time)

    def _on_step(self, request: Any) -> Tuple[bool, str, Time]:
        """Blocks this service's thread until the span is over; the owner's loop goes on meanwhile."""
        if not (math.isfinite(request.duration) and 0.0 <= request.duration <= LONGEST_STEP):
            return self._step_refused(f"duration {request.duration}: expected 0 to {LONGEST_STEP:g} s")
        jobs, time, simulator = self._simulation.jobs, self._simulation.time_control, self._simulation.simulator
        ended = jobs.call(lambda: time.begin_span(request.duration, simulator.steps))
        if ended is None:
            return self._step_refused("another step request is in progress")
        stamp = convert.to_time(stamp_ns(jobs.wait_for(ended), simulator.rate))
        return True, f"{'paused' if time.paused else 'running'} at {stamp.to_sec():.6f} s", stamp

    def _step_refused(self, reason: str) -> Tuple[bool, str, Time]:
        stamp = self._simulation.jobs.call(lambda: self._simulation.simulator.stamp_ns)
        return False, reason, convert.to_time(stamp)

    def _on_reset(self, request: Any) -> Tuple[bool, str]:
        if request.seed < 0:
            return False, f"seed {request.seed}: expected a positive number, or 0 to keep the seed"
        return True, self._simulation.jobs.call(lambda: self._reset(request.seed))

    def _reset(self, seed: int) -> str:
        self._simulation.reset(seed or None)
        simulator = self._simulation.simulator
        return (
            f"robots at their spawn poses, odometry at zero, seed {simulator.seed}; "
            f"time continues from {simulator.time:.3f} s"
        )

    def _on_reconfigure(self, config: Any, _level: int) -> Any:
        factor, current = config.real_time_factor, self._simulation.time_control.pacer.factor
        if not 0.0 <= factor < math.inf:
            rospy.logerr("real_time_factor: expected a number, 0 or more, got %g; keeping %g", factor, current)
            config.real_time_factor = current
        elif factor != current:
            rospy.loginfo("real-time factor %g, was %g", factor, current)
            simulator, time = self._simulation.simulator, self._simulation.time_control
            self._simulation.jobs.post(lambda: time.set_real_time_factor(factor, simulator.steps))
        return config
