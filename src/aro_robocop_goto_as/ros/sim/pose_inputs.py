"""Poses at which robots are to be placed: the ~set_pose service, and RViz's 2D Pose Estimate on initialpose."""

from typing import Any, List, Tuple

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped

from aro_robocop_goto_as.srv import SetPose

from ...errors import FrameError, PlaceError
from ...geometry import Pose2D, compose
from ...simulation.simulation import Simulation
from .. import convert
from ..names import prefixed


class PoseInputs:
    """Poses are resolved and robots placed in the owner's thread, between two steps."""

    def __init__(self, simulation: Simulation) -> None:
        p = simulation.simulator.p
        self._simulation = simulation
        self._frames = p.frames
        self._names: List[str] = [robot.name for robot in simulation.simulator.robots]
        for robot, name in enumerate(self._names if p.topics.has_initialpose else []):
            self._subscribe(robot, name)
        rospy.Service("~set_pose", SetPose, self._on_set_pose)

    def _subscribe(self, robot: int, name: str) -> None:
        def place(message: PoseWithCovarianceStamped) -> None:
            try:
                self._place(robot, message.header.frame_id, message.pose.pose)
            except (FrameError, PlaceError) as error:
                rospy.logerr("initialpose refused: %s", error)

        rospy.Subscriber(
            prefixed(name, "initialpose"),
            PoseWithCovarianceStamped,
            lambda message: self._simulation.jobs.post(lambda: place(message)),
        )

    def _on_set_pose(self, request: Any) -> Tuple[bool, str]:
        if request.robot not in self._names:
            known = ", ".join(map(repr, self._names))
            return False, f"robot {request.robot!r} is not one of: {known}"
        robot = self._names.index(request.robot)
        try:
            placed = self._simulation.jobs.call(
                lambda: self._place(robot, request.pose.header.frame_id, request.pose.pose)
            )
        except (FrameError, PlaceError) as error:
            return False, f"pose refused: {error}"
        return True, f"at x {placed.x:.3f} y {placed.y:.3f} yaw {placed.yaw:.3f} in the world"

    def _place(self, robot: int, frame: str, pose: Any) -> Pose2D:
        """Place a robot at a geometry_msgs/Pose in world, map or its odom.

        FrameError for any other frame; PlaceError if something is there.
        """
        target = self._in_world(robot, frame.lstrip("/"), convert.from_pose_msg(pose, unset_is_level=True))
        self._simulation.place(target, robot)
        return target

    def _in_world(self, robot: int, frame: str, pose: Pose2D) -> Pose2D:
        odom_frame = prefixed(self._names[robot], self._frames.odom_frame)
        if frame in (self._frames.world_frame, self._frames.map_frame):
            return pose
        if frame == odom_frame:
            return compose(self._simulation.simulator.map_from_odom(robot), pose)
        known = f"{self._frames.map_frame!r}, {odom_frame!r} or {self._frames.world_frame!r}"
        raise FrameError(f"its frame is {frame!r}; expected {known}")
