"""A stamped pose in any frame -> the goal's position in the server's frame, or FrameError; never raw numbers."""

import time
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
from ...process.peer import await_others, others_want_to_run
from ...suggestions import did_you_mean
from .. import convert, graph
from ..rospy_internals import publishers_of
from ..ticker import wait_until
from .discovery import PATIENCE
from .tf_buffer import TfBuffer, is_possible

POLL, LOOK = 0.01, 0.1  # [s, wall] between two looks for a transform, and for what it may be waiting for


class GoalTransformer:
    """Transforms goals into `goal_frame`; its timeouts are in wall time, so a paused simulator can't block it."""

    def __init__(
        self,
        goal_frame: str,
        default_frame: str,
        timeout: float,
        latest_odom: Callable[[], Optional[Odometry]],
        processor_time: Callable[[], float] = time.process_time,
        callbacks_want_to_run: Callable[[], bool] = others_want_to_run,
    ) -> None:
        self.goal_frame = goal_frame
        self.default_frame = default_frame
        self.timeout = timeout
        self.latest_odom = latest_odom
        self.buffer = TfBuffer()
        self.listener = tf2_ros.TransformListener(self.buffer)
        self._processor_time, self._callbacks_want_to_run = processor_time, callbacks_want_to_run

    def frame_of(self, pose: PoseStamped) -> str:
        """The frame in which a pose is given; the default where it names none."""
        return pose.header.frame_id.lstrip("/") or self.default_frame

    def resolve(self, pose: PoseStamped) -> Point:
        """The pose's position in goal_frame at the pose's stamp.

        Waits up to `timeout` [s, wall] for the transform at the goal's stamp, longer while a busy machine keeps it from
        arriving, then uses the latest one: TF's, or that of the odometry if it connects the frames and is newer. Where
        TF does not connect them but the odometry does, uses that without waiting. FrameError if the frames are not
        connected, and for a position that is not finite or beyond FARTHEST, before or after the transform.
        """
        x, y, z = (float(value) for value in ros_numpy.numpify(pose.pose.position))
        convert.require_near(x=x, y=y, z=z)
        frame = self.frame_of(pose)
        if not pose.header.frame_id.lstrip("/"):
            rospy.logwarn("goal without frame_id; assuming the default %r", frame)
        if frame == self.goal_frame:
            return Point(x, y, z)
        position = self._transform(Point(x, y, z), frame, pose.header.stamp)
        where = f" in {self.goal_frame!r}, transformed from {frame!r}"
        convert.require_near(where, x=position.x, y=position.y, z=position.z)
        return position

    def _transform(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        def at_stamp() -> Optional[Point]:
            if self._connects(frame, stamp):
                return self._by_tf(point, frame, stamp)
            odom = self._odometry_of(frame)
            return None if odom is None or self._connects(frame, rospy.Time(0)) else _by_odometry(point, odom)

        try:
            position = self._await(at_stamp)
            if position is not None:
                return position
            position = self._by_latest(point, frame)
        except tf2_ros.TransformException as error:
            known = yaml.safe_load(self.buffer.all_frames_as_yaml()) or ()
            within = f"within {self.timeout:g} s: {str(error).strip()}{did_you_mean(frame, known)}"
            raise FrameError(f"no transform from {frame!r} to {self.goal_frame!r} {within}") from error
        rospy.logwarn(
            f"no transform from {frame!r} to {self.goal_frame!r} at the goal's time {stamp.to_sec():.3f} within "
            f"{self.timeout:g} s; using the latest one"
        )
        return position

    def _await(self, at_stamp: Callable[[], Optional[Point]]) -> Optional[Point]:
        """Wait for `timeout` [s, wall], and, while it may be underway, until that is this process's processor time.

        In all it may take PATIENCE times as long: a publisher of transforms that hangs is underway for ever.
        """
        end = time.monotonic() + PATIENCE * self.timeout
        await_others(
            lambda timeout: wait_until(at_stamp, timeout, POLL) is not None,
            self.timeout,
            self.timeout,
            self._processor_time,
            lambda: time.monotonic() < end and not rospy.is_shutdown() and self._is_underway(),
            LOOK,
        )
        return at_stamp()

    def _is_underway(self) -> bool:
        """Whether a callback waits for a processor, or a publisher that lives is not connected yet."""
        topics = self.listener.tf_sub, self.listener.tf_static_sub
        return self._callbacks_want_to_run() or any(
            graph.has_living_publisher(topic.resolved_name, publishers_of(topic)) for topic in topics
        )

    def _by_tf(self, point: Point, frame: str, stamp: rospy.Time) -> Point:
        transform = self.buffer.lookup_transform(self.goal_frame, frame, stamp)
        return tf2_geometry_msgs.do_transform_point(PointStamped(point=point), transform).point

    def _by_latest(self, point: Point, frame: str) -> Point:
        """The transformed point by TF, or by the odometry if that is newer: TF's publisher may have left."""
        odom = self._odometry_of(frame)
        newest = self.buffer.lookup_transform(self.goal_frame, frame, rospy.Time(0)).header.stamp
        if odom is not None and odom.header.stamp > newest:
            return _by_odometry(point, odom)
        return self._by_tf(point, frame, rospy.Time(0))

    def _connects(self, frame: str, stamp: rospy.Time) -> bool:
        """Whether TF connects a frame with goal_frame at a stamp; does not wait."""
        return is_possible(stamp) and bool(self.buffer.can_transform(self.goal_frame, frame, stamp))

    def _odometry_of(self, frame: str) -> Optional[Odometry]:
        """The latest odometry if it connects exactly these two frames."""
        odom = self.latest_odom()
        connects = odom is not None and (odom.header.frame_id, odom.child_frame_id) == (self.goal_frame, frame)
        return odom if connects else None


def _by_odometry(point: Point, odom: Odometry) -> Point:
    """A point in the odometry's child frame, transformed into its frame."""
    try:
        goal_from_frame = convert.from_pose_msg(odom.pose.pose)
    except FrameError as error:
        raise FrameError(f"odometry holds an impossible pose of {odom.child_frame_id!r}: {error}") from error
    goal = compose(goal_from_frame, Pose2D(point.x, point.y))
    return Point(goal.x, goal.y, point.z)
