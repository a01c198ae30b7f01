"""A stamped pose in any frame -> the goal's position in the server's frame, or FrameError; never raw numbers."""

from typing import Callable, Optional

import ros_numpy
import rospy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import Point, PointStamped, PoseStamped
from nav_msgs.msg import Odometry

from ...errors import FrameError
from ...geometry import Pose2D, compose
from .. import convert
from ..ticker import wait_until
from .tf_buffer import TfBuffer, is_possible

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

        Waits up to `timeout` [s, wall] for the transform at the goal's stamp, then uses the latest one. Where TF does
        not connect the frames but the latest odometry does, uses that without waiting. FrameError if the frames are not
        connected, and for a position that is not finite or beyond FARTHEST, before or after the transform.
        """
        x, y, z = (float(value) for value in ros_numpy.numpify(pose.pose.position))
        convert.require_near(x=x, y=y, z=z)
        frame = pose.header.frame_id.lstrip("/")
        if not frame:
            frame = self.default_frame
            rospy.logwarn("goal without frame_id; assuming the default %r", frame)
        if frame == self.goal_frame:
            return Point(x, y, z)
        position = self._transform(Point(x, y, z), frame, pose.header.stamp)
        where = f" in {self.goal_frame!r}, transformed from {frame!r}"
        convert.require_near(where, x=position.x, y=position.y, z=position.z)
        return position

    def _transform(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        def at_stamp() -> Optional[Point]:
            return self._by_tf(point, frame, stamp) if self._connects(frame, stamp) else self._by_odometry(point, frame)

        try:
            position = wait_until(at_stamp, self.timeout, POLL)
            if position is not None:
                return position
            position = self._by_tf(point, frame, rospy.Time(0))
        except tf2_ros.TransformException as error:
            within = f"within {self.timeout:g} s: {error}"
            raise FrameError(f"no transform from {frame!r} to {self.goal_frame!r} {within}") from error
        rospy.logwarn(
            f"no transform from {frame!r} to {self.goal_frame!r} at the goal's time {stamp.to_sec():.3f} within "
            f"{self.timeout:g} s; using the latest one"
        )
        return position

    def _by_tf(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp)
        return tf2_geometry_msgs.do_transform_point(PointStamped(point=point), transform).point

    def _connects(self, frame: str, stamp: rospy.Time) -> bool:
        """Whether TF connects a frame with goal_frame at a stamp; does not wait."""
        return is_possible(stamp) and bool(self.buffer.can_transform(self.goal_frame, frame, stamp))

    def _by_odometry(self, point: Point, frame: str) -> Optional[Point]:
        """The transformed point if the latest odometry connects exactly these two frames, and TF does not."""
        odom = self.latest_odom()
        if odom is None or (odom.header.frame_id, odom.child_frame_id) != (self.goal_frame, frame):
            return None
        if self._connects(frame, rospy.Time(0)):
            return None
        try:
            goal_from_frame = convert.from_pose_msg(odom.pose.pose)
        except FrameError as error:
            raise FrameError(f"odometry holds an impossible pose of {frame!r}: {error}") from error
        goal = compose(goal_from_frame, Pose2D(point.x, point.y))
        return Point(goal.x, goal.y, point.z)
