"""The simulator's services: time, poses of robots, models of the world; and RViz's 2D Pose Estimate on initialpose."""

import math
from typing import Any, Callable, Dict, List, Optional

import rospy
from dynamic_reconfigure.server import Server
from geometry_msgs.msg import Pose, PoseWithCovarianceStamped
from std_srvs.srv import Trigger

from aro_robocop_goto_as.cfg import SimConfig
from aro_robocop_goto_as.srv import DeleteModel, MoveModel, Reset, SetPose, SpawnModel, Step

from ...errors import FrameError, PlaceError, ShutdownError, WorldError
from ...geometry import Pose2D, Pose3D, compose
from ...names import MAP_FRAME, ODOM_FRAME, WORLD_FRAME, prefixed
from ...simulation.agenda import stamp_ns
from ...simulation.running import RunningSimulator
from ...world.edit import requested_model, with_model, with_model_at, without_model
from ...world.model import World
from .. import convert

MAX_SPAN = 1e6  # [s]
Offer = Callable[[str, Any, Callable[[Any], Any]], object]  # of a service: name, type, request -> response
REFUSALS = FrameError, PlaceError, WorldError, ShutdownError


def serve(
    name: str,
    kind: Any,
    answer: Callable[[Any], Dict[str, Any]],
    text: str = "message",
    begin: str = "",
    offer: Offer = rospy.Service,
) -> None:
    """Offer a service; a refused request is answered with success false and the reason.

    answer: request -> the fields of the response except success; text: the field for a refusal's reason, which starts
    with `begin`
    """

    def respond(request: Any) -> Dict[str, Any]:
        try:
            return {"success": True, **answer(request)}
        except REFUSALS as error:
            return {"success": False, text: f"{begin}{error}"}

    offer(name, kind, respond)


class SimulatorServices:
    """Files are read in the service's thread; all else is done in the simulation thread, between two steps."""

    def __init__(self, running: RunningSimulator) -> None:
        p = running.simulator.params
        self._running, self._simulator = running, running.simulator
        self._call = running.jobs.call
        self._names: List[str] = [robot.name for robot in running.simulator.robots]
        serve("~pause", Trigger, lambda _: {"message": self._call(lambda: self.set_paused(True))})
        serve("~unpause", Trigger, lambda _: {"message": self._call(lambda: self.set_paused(False))})
        serve("~step", Step, self._on_step)
        serve("~reset", Reset, self._on_reset)
        serve("~spawn_model", SpawnModel, lambda r: {"message": self.spawn(r.name, r.xml, r.file, _pose_of(r))})
        serve("~delete_model", DeleteModel, lambda r: {"message": self.delete(r.name)})
        serve("~move_model", MoveModel, lambda r: {"message": self.move(r.name, _pose_of(r))})
        serve("~set_pose", SetPose, self._on_set_pose, begin="pose refused: ")
        for robot, name in enumerate(self._names if p.topics.has_initialpose else []):
            self._subscribe(robot, name)
        self._factor: float = running.time_control.pacer.factor  # asked for last; the simulation thread may lag behind
        rospy.set_param("~real_time_factor", self._factor)  # its server begins here
        self._reconfigure = Server(SimConfig, self._on_reconfigure)

    # -- time --

    def set_paused(self, paused: bool) -> str:
        """Pause or resume simulated time, in the simulation thread; returns what was done."""
        self._running.set_paused(paused)
        if paused and not self._running.time_control.standing:
            return "will be paused when the step that is in progress ends"
        return "{} at {:.3f} s".format("paused" if paused else "running", self._simulator.time)

    def _on_step(self, request: Any) -> Dict[str, Any]:
        """Blocks this service's thread until the span is over; the simulation thread's loop goes on meanwhile."""
        time, rate = self._running.time_control, self._simulator.rate
        if not (math.isfinite(request.duration) and 0.0 <= request.duration <= MAX_SPAN):
            return self._step_refused(f"duration {request.duration}: expected 0 to {MAX_SPAN:g} s")
        ended = self._call(lambda: time.begin_span(request.duration, self._simulator.steps))
        if ended is None:
            return self._step_refused("another step request is in progress")
        stamp = convert.to_time(stamp_ns(self._running.jobs.wait_for(ended), rate))
        state = "paused" if time.paused else "running"
        return {"message": f"{state} at {stamp.to_sec():.6f} s", "stamp": stamp}

    def _step_refused(self, reason: str) -> Dict[str, Any]:
        stamp = self._call(lambda: self._simulator.stamp_ns)
        return {"success": False, "message": reason, "stamp": convert.to_time(stamp)}

    def _on_reset(self, request: Any) -> Dict[str, Any]:
        if request.seed < 0:
            reason = f"seed {request.seed}: expected a positive number, or 0 to keep the seed"
            return {"success": False, "message": reason}
        return {"message": self._call(lambda: self._reset(request.seed or None))}

    def _reset(self, seed: Optional[int]) -> str:
        self._simulator.reset(seed)
        seed, time = self._simulator.seed, self._simulator.time
        return f"robots at their spawn poses, odometry zero, seed {seed}, at {time:.3f} s"

    def _on_reconfigure(self, config: Any, _level: int) -> Any:
        time = self._running.time_control
        factor, current = config.real_time_factor, self._factor
        if not 0.0 <= factor < math.inf:
            rospy.logerr("real_time_factor: expected a number, 0 or more, got %g; keeping %g", factor, current)
            config.real_time_factor = current
        elif factor != current:
            rospy.loginfo("real-time factor %g, was %g", factor, current)
            self._factor = factor
            self._running.jobs.post(lambda: time.set_real_time_factor(factor, self._simulator.steps))
        return config

    # -- the world --

    def _change(self, edit: Callable[[World], World]) -> None:
        self._call(lambda: self._simulator.change_world(edit(self._simulator.world)))

    def spawn(self, name: str, xml: str, file: str, pose: Pose3D) -> str:
        """Add a model, as requested_model reads it; returns what was done. WorldError where that is not possible."""
        model = requested_model(name, xml, file, pose, self._simulator.world.path)
        self._change(lambda world: with_model(world, model))
        ignored = f"; ignored: {', '.join(model.ignored)}" if model.ignored else ""
        differs = f"; different: {', '.join(model.approximated)}" if model.approximated else ""
        return f"model '{model.name}' with {len(model.obstacles)} collisions{ignored}{differs}"

    def delete(self, name: str) -> str:
        """Remove a model; returns what was done. WorldError if there is none of that name."""
        self._change(lambda world: without_model(world, name))
        return f"model '{name}' deleted"

    def move(self, name: str, pose: Pose3D) -> str:
        """Move a model; returns what was done. WorldError if there is none of that name."""
        self._change(lambda world: with_model_at(world, name, pose))
        return "model '{}' at x {:.3f} y {:.3f} z {:.3f}".format(name, *pose.position)

    # -- poses of robots --

    def _subscribe(self, robot: int, name: str) -> None:
        def place(message: PoseWithCovarianceStamped) -> None:
            try:
                self._place(robot, message.header.frame_id, message.pose.pose)
            except REFUSALS as error:
                rospy.logerr("initialpose refused: %s", error)

        rospy.Subscriber(
            prefixed(name, "initialpose"),
            PoseWithCovarianceStamped,
            lambda message: self._running.jobs.post(lambda: place(message)),
        )

    def _on_set_pose(self, request: Any) -> Dict[str, Any]:
        if request.robot not in self._names:
            known = ", ".join(map(repr, self._names))
            return {"success": False, "message": f"robot {request.robot!r} is not one of: {known}"}
        robot, pose = self._names.index(request.robot), request.pose
        placed = self._call(lambda: self._place(robot, pose.header.frame_id, pose.pose))
        return {"message": f"at x {placed.x:.3f} y {placed.y:.3f} yaw {placed.yaw:.3f} in the world"}

    def _place(self, robot: int, frame: str, pose: Pose) -> Pose2D:
        """Place a robot at a pose in world, map or its odom.

        FrameError for any other frame; PlaceError if something is there.
        """
        target = self._in_world(robot, frame.lstrip("/"), convert.from_pose_msg(pose, unset_is_level=True))
        self._simulator.require_room(target, robot)
        self._simulator.place(target, robot)
        return target

    def _in_world(self, robot: int, frame: str, pose: Pose2D) -> Pose2D:
        odom_frame = prefixed(self._names[robot], ODOM_FRAME)
        if frame in (WORLD_FRAME, MAP_FRAME):
            return pose
        if frame == odom_frame:
            return compose(self._simulator.map_from_odom(robot), pose)
        known = f"{MAP_FRAME!r}, {odom_frame!r} or {WORLD_FRAME!r}"
        raise FrameError(f"its frame is {frame!r}; expected {known}")


def _pose_of(request: Any) -> Pose3D:
    return convert.from_pose_msg_3d(request.pose)
