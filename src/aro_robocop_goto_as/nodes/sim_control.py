"""Services that hold simulated time in a person's or a test's hands: pause, unpause, step, reset, set_pose, factor."""

import math
import queue
from typing import TYPE_CHECKING, Any

import rospy
from dynamic_reconfigure.server import Server
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from aro_robocop_goto_as.cfg import SimConfig
from aro_robocop_goto_as.srv import (
    Reset,
    ResetRequest,
    ResetResponse,
    SetPose,
    SetPoseRequest,
    SetPoseResponse,
    Step,
    StepRequest,
    StepResponse,
)

from ..errors import FrameError
from . import convert

if TYPE_CHECKING:
    from .sim import SimNode

LONGEST_STEP = 1e6  # [s]


class SimControl:
    """Every request is carried out in the loop's thread, between two steps."""

    def __init__(self, node: "SimNode") -> None:
        self.node = node
        rospy.Service("~pause", Trigger, self._on_pause)
        rospy.Service("~unpause", Trigger, self._on_unpause)
        rospy.Service("~step", Step, self._on_step)
        rospy.Service("~reset", Reset, self._on_reset)
        rospy.Service("~set_pose", SetPose, self._on_set_pose)
        self.reconfigure = Server(SimConfig, self._on_reconfigure)

    def _on_pause(self, _request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(True, self.node.in_loop(lambda: self.set_paused(True)))

    def _on_unpause(self, _request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(True, self.node.in_loop(lambda: self.set_paused(False)))

    def set_paused(self, paused: bool) -> str:
        """Let simulated time stand, or go on."""
        node = self.node
        node.paused = paused
        node.pacer.restart(node.sim.time)
        node.status.publish()
        return "{} at {:.3f} s".format("paused" if paused else "running", node.sim.time)

    def _on_step(self, request: StepRequest) -> StepResponse:
        """Blocks this service's thread until the span is over; the loop goes on meanwhile."""
        if not (math.isfinite(request.duration) and 0.0 <= request.duration <= LONGEST_STEP):
            return StepResponse(False, f"duration {request.duration}: expected 0 to {LONGEST_STEP:g} s",
                                self.node.in_loop(self._stamp))
        ended: queue.Queue[Any] = queue.Queue()
        refusal = self.node.in_loop(lambda: self._begin_span(request.duration, ended))
        if refusal:
            return StepResponse(False, refusal, self.node.in_loop(self._stamp))
        while not rospy.is_shutdown():
            try:
                stamp = ended.get(timeout=0.1)
            except queue.Empty:
                continue
            return StepResponse(True, f"standing at {stamp.to_sec():.6f} s", stamp)
        raise rospy.ServiceException("the simulator is shutting down")

    def _begin_span(self, duration: float, ended: "queue.Queue[Any]") -> str:
        node = self.node
        if node.run_until:
            return "another step request is being carried out"
        node.run_until = node.sim.steps + max(1, int(round(duration * node.p.physics_rate)))
        node.on_span_end = lambda: ended.put(self._stamp())
        node.pacer.restart(node.sim.time)
        return ""

    def _stamp(self) -> rospy.Time:
        return convert.to_time(self.node.sim.stamp_ns)

    def _on_reset(self, request: ResetRequest) -> ResetResponse:
        if request.seed < 0:
            return ResetResponse(False, f"seed {request.seed}: expected a positive number, or 0 to keep the seed")
        return ResetResponse(True, self.node.in_loop(lambda: self.reset(request.seed)))

    def reset(self, seed: int) -> str:
        """Robots to their spawn poses, odometry to zero, noise from its start; seed 0 keeps the seed."""
        node = self.node
        node.sim.reset(seed or None, restart_time=node.p.reset_time)
        node.held.clear()
        node.placed.update(range(len(node.robots)))
        node.lockstep.restart(node.tick())
        node.pacer.restart(node.sim.time)
        if node.p.reset_time:
            node.clock.publish(self._stamp())
        node.send_static_transforms()
        node.status.publish()
        time = f"{node.sim.time:.3f} s"
        return f"robots at their spawn poses, odometry at zero, seed {node.sim.seed}; time goes on from {time}"

    def _on_set_pose(self, request: SetPoseRequest) -> SetPoseResponse:
        names = [robot.name for robot in self.node.robots]
        if request.robot not in names:
            return SetPoseResponse(False, "robot {!r} is not one of: {}".format(
                request.robot, ", ".join(map(repr, names))))
        index = names.index(request.robot)
        try:
            pose = self.node.in_loop(
                lambda: self.node.place(index, request.pose.header.frame_id, request.pose.pose))
        except FrameError as error:
            return SetPoseResponse(False, f"pose refused: {error}")
        return SetPoseResponse(True, f"at x {pose.x:.3f} y {pose.y:.3f} yaw {pose.yaw:.3f} in the world")

    def _on_reconfigure(self, config: Any, _level: int) -> Any:
        factor = config.real_time_factor
        if not 0.0 <= factor < math.inf:
            config.real_time_factor = self.node.pacer.factor
            rospy.logerr("real_time_factor: expected a number, 0 or more, got %g; it stays %g", factor,
                         config.real_time_factor)
            return config
        self.node.jobs.put(lambda: self.set_factor(factor))
        return config

    def set_factor(self, factor: float) -> None:
        """Run at this factor from now on; 0 = as fast as possible."""
        if factor != self.node.pacer.factor:
            rospy.loginfo("real-time factor %g, was %g", factor, self.node.pacer.factor)
            self.node.pacer.factor = factor
            self.node.pacer.restart(self.node.sim.time)
