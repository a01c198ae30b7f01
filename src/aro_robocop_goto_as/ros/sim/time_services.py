"""Services that control simulated time: pause, unpause, step, reset; and the real-time factor."""

import math
from concurrent.futures import Future
from typing import Any

import rospy
from dynamic_reconfigure.server import Server
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from aro_robocop_goto_as.cfg import SimConfig
from aro_robocop_goto_as.srv import Reset, ResetRequest, ResetResponse, Step, StepRequest, StepResponse

from ...simulation.loop import SimulationLoop
from .. import convert

LONGEST_STEP = 1e6  # [s]


class TimeServices:
    """Every request is carried out in the loop's thread, between two steps."""

    def __init__(self, loop: SimulationLoop) -> None:
        self._loop = loop
        rospy.Service("~pause", Trigger, self._on_pause)
        rospy.Service("~unpause", Trigger, self._on_unpause)
        rospy.Service("~step", Step, self._on_step)
        rospy.Service("~reset", Reset, self._on_reset)
        rospy.set_param("~real_time_factor", loop.pacer.factor)  # from which the server of dynamic_reconfigure starts
        self._reconfigure = Server(SimConfig, self._on_reconfigure)

    def _on_pause(self, _request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(True, self._loop.call(lambda: self._set_paused(True)))

    def _on_unpause(self, _request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(True, self._loop.call(lambda: self._set_paused(False)))

    def _set_paused(self, paused: bool) -> str:
        self._loop.set_paused(paused)
        return "{} at {:.3f} s".format("paused" if paused else "running", self._loop.simulator.time)

    def _on_step(self, request: StepRequest) -> StepResponse:
        """Blocks this service's thread until the span is over; the loop goes on meanwhile."""
        ended: Future[rospy.Time] = Future()
        if not (math.isfinite(request.duration) and 0.0 <= request.duration <= LONGEST_STEP):
            refusal = f"duration {request.duration}: expected 0 to {LONGEST_STEP:g} s"
        elif not self._loop.call(
            lambda: self._loop.begin_span(request.duration, lambda: ended.set_result(self._stamp()))
        ):
            refusal = "another step request is in progress"
        else:
            stamp = self._loop.wait_for(ended)
            state = "paused" if self._loop.paused else "running"
            return StepResponse(True, f"{state} at {stamp.to_sec():.6f} s", stamp)
        return StepResponse(False, refusal, self._loop.call(self._stamp))

    def _stamp(self) -> rospy.Time:
        return convert.to_time(self._loop.simulator.stamp_ns)

    def _on_reset(self, request: ResetRequest) -> ResetResponse:
        if request.seed < 0:
            return ResetResponse(False, f"seed {request.seed}: expected a positive number, or 0 to keep the seed")
        return ResetResponse(True, self._loop.call(lambda: self._reset(request.seed)))

    def _reset(self, seed: int) -> str:
        self._loop.reset(seed or None)
        simulator = self._loop.simulator
        return (
            f"robots at their spawn poses, odometry at zero, seed {simulator.seed}; "
            f"time continues from {simulator.time:.3f} s"
        )

    def _on_reconfigure(self, config: Any, _level: int) -> Any:
        factor, current = config.real_time_factor, self._loop.pacer.factor
        if not 0.0 <= factor < math.inf:
            rospy.logerr("real_time_factor: expected a number, 0 or more, got %g; it stays %g", factor, current)
            config.real_time_factor = current
        elif factor != current:
            rospy.loginfo("real-time factor %g, was %g", factor, current)
            self._loop.post(lambda: self._loop.set_real_time_factor(factor))
        return config
