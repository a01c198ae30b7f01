"""A stamped pose in any frame -> the goal's position in the server's frame, or a refusal; never raw numbers."""

import math
import time
from typing import Callable, Optional, Tuple

import ros_numpy
import rospy
import tf2_geometry_msgs  # noqa: F401  registers the pose types with tf2
import tf2_ros
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry

from ..errors import FrameError
from ..geometry import Pose2D, compose
from . import convert

POLL = 0.01  # [s, wall]


class GoalTransformer:
    """Resolves goals into `goal_frame`; waits on the wall clock, so a paused simulator can't block it."""

    def __init__(self, goal_frame: str, default_frame: str, timeout: float,
                 latest_odom: Callable[[], Optional[Odometry]]) -> None:
        self.goal_frame = goal_frame
        self.default_frame = default_frame
        self.timeout = timeout
        self.latest_odom = latest_odom
        self.buffer = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.buffer)

    def resolve(self, pose: PoseStamped) -> Point:
        """The pose's position in goal_frame, taken at the pose's stamp.

        When TF knows that frame but not yet that time, waits up to `timeout` [s, wall], then takes the latest
        transform. Where TF knows no way but the frame is the odometry's child_frame_id, the latest odometry serves.
        FrameError names both frames when neither works; also on numbers that are not finite.
        """
        x, y, z = (float(value) for value in ros_numpy.numpify(pose.pose.position))
        if not all(map(math.isfinite, (x, y, z))):
            raise FrameError(f"position x {x} y {y} z {z}: expected finite numbers in metres")
        frame = pose.header.frame_id.lstrip("/")
        if not frame:
            frame = self.default_frame
            rospy.logwarn("the goal names no frame; taken as %r, the default", frame)
        if frame == self.goal_frame:
            return Point(x, y, z)
        return self._transformed(Point(x, y, z), frame, pose.header.stamp)

    def _transformed(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        deadline = time.monotonic() + self.timeout
        while True:
            found, reason = self._try(point, frame, stamp)
            if found is not None:
                return found
            if not self._tf_knows(frame):
                by_odometry = self._by_odometry(point, frame)
                if by_odometry is not None:
                    return by_odometry
            if time.monotonic() >= deadline or rospy.is_shutdown():
                break
            time.sleep(POLL)
        found, reason = self._try(point, frame, rospy.Time(0))
        if found is None:
            raise FrameError(f"no transform from {frame!r} to {self.goal_frame!r} within {self.timeout:g} s: {reason}")
        rospy.logwarn("no transform from %r to %r at the goal's time %.3f within %g s; the latest one is used",
                      frame, self.goal_frame, stamp.to_sec(), self.timeout)
        return found

    def _try(self, point: Point, frame: str, stamp: rospy.Time) -> Tuple[Optional[Point], str]:
        """One look at TF without waiting: the point, or why not."""
        asked = PoseStamped()
        asked.header.frame_id, asked.header.stamp = frame, stamp
        asked.pose.position = point
        asked.pose.orientation.w = 1.0
        try:
            transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp)
        except tf2_ros.TransformException as error:
            return None, str(error)
        return tf2_geometry_msgs.do_transform_pose(asked, transform).pose.position, ""

    def _tf_knows(self, frame: str) -> bool:
        return self.buffer.can_transform(self.goal_frame, frame, rospy.Time(0))

    def _by_odometry(self, point: Point, frame: str) -> Optional[Point]:
        """By the odometry message, which is a transform too; None unless it speaks of just these two frames."""
        odom = self.latest_odom()
        if odom is None or (odom.header.frame_id, odom.child_frame_id) != (self.goal_frame, frame):
            return None
        there = compose(convert.from_pose_msg(odom.pose.pose), Pose2D(point.x, point.y))
        return Point(there.x, there.y, point.z)
