"""A stamped pose in any frame -> the goal's position in the server's frame, or FrameError; never raw numbers."""

from typing import Callable, Optional

import ros_numpy
import rospy
import tf2_geometry_msgs
import tf2_ros
import yaml
from geometry_msgs.msg import Point, PointStamped, PoseStamped
from nav_msgs.msg import Odometry

from ...errors import FrameError
from ...geometry import Pose2D, compose
from ...suggestions import did_you_mean
from .. import convert
from ..waiting import wait_until

MAX_STAMP = 2**31 - 1  # [s] at a later one tf2 ends the process: the difference of two is more than 32 bits


class GoalTransformer:
    """Transforms goals into `goal_frame`; its timeout is in wall time, so a paused simulator can't block it."""

    def __init__(
        self, goal_frame: str, default_frame: str, timeout: float, latest_odom: Callable[[], Optional[Odometry]]
    ) -> None:
        self.goal_frame = goal_frame
        self.default_frame = default_frame
        self.timeout = timeout
        self.latest_odom = latest_odom
        self.buffer = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.buffer)

    def frame_of(self, pose: PoseStamped) -> str:
        """The frame in which a pose is given; the default where it names none."""
        return pose.header.frame_id.lstrip("/") or self.default_frame

    def resolve(self, pose: PoseStamped) -> Point:
        """The pose's position in goal_frame, by the first of these that connects the two frames:

        1. the transform of TF at the pose's stamp, waited for up to `timeout` [s, wall]; not waited for where TF does
           not connect the frames at any time and odometry does;
        2. the latest odometry, if it is from goal_frame to the pose's frame;
        3. the latest transform of TF.

        FrameError if none does, and for a position that is not finite or beyond MAX_COORDINATE, before or after the
        transform.
        """
        x, y, z = (float(value) for value in ros_numpy.numpify(pose.pose.position))
        convert.require_near(x=x, y=y, z=z)
        frame = self.frame_of(pose)
        if not pose.header.frame_id.lstrip("/"):
            rospy.logwarn("goal without frame_id; assuming the default %r", frame)
        if frame == self.goal_frame:
            return Point(x, y, z)
        try:
            position = self._transform(Point(x, y, z), frame, pose.header.stamp)
        except tf2_ros.TransformException as error:
            known = yaml.safe_load(self.buffer.all_frames_as_yaml()) or ()
            within = f"within {self.timeout:g} s: {str(error).strip()}{did_you_mean(frame, known)}"
            raise FrameError(f"no transform from {frame!r} to {self.goal_frame!r} {within}") from error
        convert.require_near(x=position.x, y=position.y, z=position.z)
        return position

    def _transform(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        def connects(time: rospy.Time) -> bool:
            return time.secs <= MAX_STAMP and bool(self.buffer.can_transform(self.goal_frame, frame, time))

        def odometry() -> Optional[Odometry]:
            """The latest odometry if it connects exactly these two frames."""
            odom = self.latest_odom()
            found = odom is not None and (odom.header.frame_id, odom.child_frame_id) == (self.goal_frame, frame)
            return odom if found else None

        latest = rospy.Time(0)
        wait_until(lambda: connects(stamp) or (odometry() and not connects(latest)), self.timeout)
        if connects(stamp):
            return self._by_tf(point, frame, stamp)
        odom = odometry()
        position = self._by_tf(point, frame, latest) if odom is None else _by_odometry(point, odom)
        if connects(latest):
            rospy.logwarn(
                f"no transform from {frame!r} to {self.goal_frame!r} at the goal's time {stamp.to_sec():.3f} within "
                f"{self.timeout:g} s; using the latest one"
            )
        return position

    def _by_tf(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp)
        return tf2_geometry_msgs.do_transform_point(PointStamped(point=point), transform).point


def _by_odometry(point: Point, odom: Odometry) -> Point:
    """A point in the odometry's child frame, transformed into its frame."""
    try:
        goal_from_frame = convert.from_pose_msg(odom.pose.pose)
    except FrameError as error:
        raise FrameError(f"odometry holds an impossible pose of {odom.child_frame_id!r}: {error}") from error
    goal = compose(goal_from_frame, Pose2D(point.x, point.y))
    return Point(goal.x, goal.y, point.z)
