"""Poses at which robots are to be placed: the ~set_pose service, and RViz's 2D Pose Estimate on initialpose."""

from typing import Any, List

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped

from aro_robocop_goto_as.srv import SetPose, SetPoseRequest, SetPoseResponse

from ...component_params import FrameNames
from ...errors import FrameError, PlaceError
from ...geometry import Pose2D, compose
from ...simulation.loop import SimulationLoop
from .. import convert
from .robot_topics import prefixed


class PoseInputs:
    """Poses are resolved and robots placed in the loop's thread, between two steps."""

    def __init__(self, loop: SimulationLoop, frames: FrameNames, initialpose: bool) -> None:
        """Without `initialpose` that topic is not subscribed to, so that amcl alone receives it."""
        self._loop = loop
        self._frames = frames
        self._names: List[str] = [robot.name for robot in loop.simulator.robots]
        for robot, name in enumerate(self._names if initialpose else []):
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
            lambda message: self._loop.post(lambda: place(message)),
        )

    def _on_set_pose(self, request: SetPoseRequest) -> SetPoseResponse:
        if request.robot not in self._names:
            known = ", ".join(map(repr, self._names))
            return SetPoseResponse(False, f"robot {request.robot!r} is not one of: {known}")
        robot = self._names.index(request.robot)
        try:
            pose = self._loop.call(lambda: self._place(robot, request.pose.header.frame_id, request.pose.pose))
        except (FrameError, PlaceError) as error:
            return SetPoseResponse(False, f"pose refused: {error}")
        return SetPoseResponse(True, f"at x {pose.x:.3f} y {pose.y:.3f} yaw {pose.yaw:.3f} in the world")

    def _place(self, robot: int, frame: str, pose: Any) -> Pose2D:
        """Place a robot at a geometry_msgs/Pose in world, map or its odom.

        FrameError for any other frame; PlaceError if something is there.
        """
        target = self._in_world(robot, frame.lstrip("/"), convert.to_possible_pose(pose))
        self._loop.place_with_room(target, robot)
        return target

    def _in_world(self, robot: int, frame: str, pose: Pose2D) -> Pose2D:
        odom_frame = prefixed(self._names[robot], self._frames.odom)
        if frame in (self._frames.world, self._frames.map):
            return pose
        if frame == odom_frame:
            return compose(self._loop.simulator.map_from_odom(robot), pose)
        known = f"{self._frames.map!r}, {odom_frame!r} or {self._frames.world!r}"
        raise FrameError(f"its frame is {frame!r}; expected {known}")
