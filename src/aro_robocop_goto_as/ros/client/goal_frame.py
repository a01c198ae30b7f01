"""A stamped pose in any frame -> the goal's position in the server's frame, or FrameError; never raw numbers."""

import time
from typing import Callable, Optional, Tuple

import ros_numpy
import rospy
import tf2_geometry_msgs  # noqa: F401  registers the pose types with tf2
import tf2_ros
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from ...errors import FrameError
from ...geometry import FARTHEST, Pose2D, compose
from .. import convert
from .tf_buffer import STAMP_LIMIT, TfBuffer, is_possible

POLL = 0.01  # [s, wall]


class GoalTransformer:
    """Transforms goals into `goal_frame`; its timeouts are in wall time, so a paused simulator can't block it."""

    def __init__(
        self, goal_frame: str, default_frame: str, timeout: float, latest_odom: Callable[[], Optional[Odometry]]
    ) -> None:
        self.goal_frame = goal_frame
        self.default_frame = default_frame
        self.timeout = timeout
        self.latest_odom = latest_odom
        self.buffer = TfBuffer()
        self.listener = tf2_ros.TransformListener(self.buffer)

    def resolve(self, pose: PoseStamped) -> Point:
        """The pose's position in goal_frame at the pose's stamp.

        Waits up to `timeout` [s, wall] for the transform at the goal's stamp. Then uses the latest transform;
        FrameError if the frames are not connected. Where TF does not connect them but the latest odometry does, uses
        that without waiting. FrameError also for a position that is not
        finite or beyond FARTHEST, before or after the transform.
        """
        x, y, z = (float(value) for value in ros_numpy.numpify(pose.pose.position))
        _require_near(x, y, z)
        frame = pose.header.frame_id.lstrip("/")
        if not frame:
            frame = self.default_frame
            rospy.logwarn("the goal has no frame_id; the default %r is assumed", frame)
        if frame == self.goal_frame:
            return Point(x, y, z)
        position = self._transform(Point(x, y, z), frame, pose.header.stamp)
        _require_near(position.x, position.y, position.z, f" in {self.goal_frame!r}, transformed from {frame!r}")
        return position

    def _transform(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        deadline = time.monotonic() + self.timeout
        while True:
            transformed, _ = self._transform_at(point, frame, stamp)
            if transformed is None and not self.buffer.can_transform(self.goal_frame, frame, rospy.Time(0)):
                transformed = self._transform_by_odometry(point, frame)
            if transformed is not None:
                return transformed
            if time.monotonic() >= deadline or rospy.is_shutdown():
                break
            time.sleep(POLL)
        transformed, reason = self._transform_at(point, frame, rospy.Time(0))
        if transformed is None:
            raise FrameError(f"no transform from {frame!r} to {self.goal_frame!r} within {self.timeout:g} s: {reason}")
        rospy.logwarn(
            "no transform from %r to %r at the goal's time %.3f within %g s; the latest one is used",
            frame,
            self.goal_frame,
            stamp.to_sec(),
            self.timeout,
        )
        return transformed

    def _transform_at(self, point: Point, frame: str, stamp: rospy.Time) -> Tuple[Optional[Point], str]:
        """The transformed point, or None with the reason; does not wait."""
        if not is_possible(stamp):
            return None, f"the stamp of {stamp.secs} s is beyond {STAMP_LIMIT} s"
        pose = PoseStamped()
        pose.header.frame_id, pose.header.stamp = frame, stamp
        pose.pose.position = point
        pose.pose.orientation.w = 1.0
        try:
            transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp)
        except tf2_ros.TransformException as error:
            return None, str(error)
        return tf2_geometry_msgs.do_transform_pose(pose, transform).pose.position, ""

    def _transform_by_odometry(self, point: Point, frame: str) -> Optional[Point]:
        """The transformed point if the latest odometry message connects exactly these two frames."""
        odom = self.latest_odom()
        if odom is None or (odom.header.frame_id, odom.child_frame_id) != (self.goal_frame, frame):
            return None
        try:
            goal_from_frame = convert.to_possible_pose(odom.pose.pose)
        except FrameError as error:
            raise FrameError(f"odometry holds an impossible pose of {frame!r}: {error}") from error
        goal = compose(goal_from_frame, Pose2D(point.x, point.y))
        return Point(goal.x, goal.y, point.z)


def _require_near(x: float, y: float, z: float, where: str = "") -> None:
    if not all(abs(value) <= FARTHEST for value in (x, y, z)):  # false for NaN
        raise FrameError(f"position x {x} y {y} z {z}{where}: expected finite numbers within +-{FARTHEST:g} m")
