"""A stamped pose in any frame -> the goal's position in the server's frame, or FrameError; never raw numbers."""

import ros_numpy
import rospy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import Point, PointStamped, PoseStamped

from ...errors import FrameError
from .. import convert
from ..waiting import wait_until

LATEST = rospy.Time(0)
MAX_STAMP = 2**31 - 1  # [s] at a later one tf2 ends the process: the difference of two is more than 32 bits


class GoalTransformer:
    """Transforms goals into `goal_frame`; its timeout is in wall time, so a paused simulator can't block it."""

    def __init__(self, goal_frame: str, default_frame: str, timeout: float) -> None:
        self.goal_frame = goal_frame
        self.default_frame = default_frame
        self.timeout = timeout
        self.buffer = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.buffer)

    def frame_of(self, pose: PoseStamped) -> str:
        """The frame in which a pose is given; the default where it names none."""
        return pose.header.frame_id.lstrip("/") or self.default_frame

    def resolve(self, pose: PoseStamped) -> Point:
        """The pose's position in goal_frame, by the transform at its stamp or, after `timeout`, by the latest one.

        FrameError if there is none, and for a position that is not finite or beyond MAX_COORDINATE, before or after
        the transform.
        """
        point = Point(*(float(value) for value in ros_numpy.numpify(pose.pose.position)))
        convert.require_near(x=point.x, y=point.y, z=point.z)
        frame = self.frame_of(pose)
        if not pose.header.frame_id.lstrip("/"):
            rospy.logwarn("goal without frame_id; assuming the default %r", frame)
        if frame == self.goal_frame:
            return point
        point = self._transform(point, frame, pose.header.stamp)
        convert.require_near(x=point.x, y=point.y, z=point.z)
        return point

    def _transform(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        def is_known() -> bool:
            return stamp.secs <= MAX_STAMP and bool(self.buffer.can_transform(self.goal_frame, frame, stamp))

        what, at_stamp = f"no transform from {frame!r} to {self.goal_frame!r}", wait_until(is_known, self.timeout)
        try:
            transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp if at_stamp else LATEST)
        except tf2_ros.TransformException as error:
            raise FrameError(f"{what} within {self.timeout:g} s: {str(error).strip()}") from error
        if not at_stamp:
            time = f"at the goal's time {stamp.to_sec():.3f} within {self.timeout:g} s"
            rospy.logwarn("%s %s; using the latest one", what, time)
        return tf2_geometry_msgs.do_transform_point(PointStamped(point=point), transform).point
