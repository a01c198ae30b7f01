"""What the neighbours share: poses on the plane as (x [m], y [m], yaw [rad]), occupancy grids, a message filter."""

import collections
import math
import threading

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion

QUEUE = 50  # messages that wait for their transform, as in tf2_ros::MessageFilter's users
OCCUPIED = 65  # [%] from which a cell counts as an obstacle


def yaw_of(q):
    """The yaw of a quaternion message."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def quaternion(yaw):
    """A quaternion message of a yaw."""
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def pose_of(transform):
    """The pose in a TransformStamped."""
    t = transform.transform
    return t.translation.x, t.translation.y, yaw_of(t.rotation)


def compose(a, b):
    """Pose `b`, given in the frame of pose `a`, in the frame in which `a` is given; arrays of poses are possible."""
    cos, sin = np.cos(a[2]), np.sin(a[2])
    return a[0] + cos * b[0] - sin * b[1], a[1] + sin * b[0] + cos * b[1], wrap(a[2] + b[2])


def inverse(a):
    """The pose of the frame in which `a` is given, in the frame of `a`."""
    cos, sin = np.cos(a[2]), np.sin(a[2])
    return -cos * a[0] - sin * a[1], sin * a[0] - cos * a[1], wrap(-a[2])


def wrap(angle):
    """An angle within +-pi."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


class Grid:
    """An OccupancyGrid: cells (rows, columns), row 0 at the origin's y."""

    def __init__(self, message):
        self.header, self.info = message.header, message.info
        self.resolution = message.info.resolution
        self.origin = message.info.origin.position.x, message.info.origin.position.y
        self.cells = np.array(message.data, np.int8).reshape(message.info.height, message.info.width)

    def cells_at(self, x, y):
        """Rows and columns of points [m], cut to the grid."""
        columns = np.floor((np.asarray(x) - self.origin[0]) / self.resolution).astype(int)
        rows = np.floor((np.asarray(y) - self.origin[1]) / self.resolution).astype(int)
        return np.clip(rows, 0, self.cells.shape[0] - 1), np.clip(columns, 0, self.cells.shape[1] - 1)

    def point_at(self, row, column):
        """The middle of a cell [m]."""
        return self.origin[0] + (column + 0.5) * self.resolution, self.origin[1] + (row + 0.5) * self.resolution


def rings(occupied, count):
    """How many cells away the nearest occupied one is, at most `count`; diagonal steps count as one."""
    distance, reached = np.full(occupied.shape, count), occupied.copy()
    distance[reached] = 0
    for ring in range(1, count):
        padded = np.pad(reached, 1)
        for row in range(3):
            for column in range(3):
                reached |= padded[row : row + reached.shape[0], column : column + reached.shape[1]]
        distance[reached & (distance == count)] = ring
    return distance


def returns_of(scan):
    """Which beams of a scan have a return, and x and y of all beams' ends [m], at range_max without one."""
    ranges = np.array(scan.ranges)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    hit = (ranges > scan.range_min) & (ranges < scan.range_max)
    ends = np.where(hit, ranges, np.where(np.isposinf(ranges), scan.range_max, 0.0))
    return hit, ends * np.cos(angles), ends * np.sin(angles)


class TransformedScans:
    """Hands scans on in their order once a frame is connected to theirs at their stamps, as a tf message filter does.

    What is older than the buffer, or finds the queue full, is dropped and counted.
    """

    def __init__(self, buffer, topic, frame, callback):
        from sensor_msgs.msg import LaserScan
        from tf2_msgs.msg import TFMessage

        self._buffer, self._frame, self._callback = buffer, frame, callback
        self._waiting, self._lock = collections.deque(), threading.Lock()
        self.used = self.dropped = 0
        rospy.Subscriber(topic, LaserScan, self._on_scan)
        rospy.Subscriber("/tf", TFMessage, lambda message: self._hand_on())

    def _on_scan(self, scan):
        with self._lock:
            if len(self._waiting) == QUEUE:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append(scan)
        self._hand_on()

    def _hand_on(self):
        with self._lock:
            while self._waiting:
                scan = self._waiting[0]
                try:
                    transform = self._buffer.lookup_transform(self._frame, scan.header.frame_id, scan.header.stamp)
                except tf2_ros.TransformException:
                    if not self._is_too_old(scan):
                        return
                    self.dropped += 1
                else:
                    self.used += 1
                    self._callback(scan, pose_of(transform))
                self._waiting.popleft()

    def _is_too_old(self, scan):
        """Whether the transform is known, but from after the scan."""
        try:
            newest = self._buffer.lookup_transform(self._frame, scan.header.frame_id, rospy.Time(0)).header.stamp
        except tf2_ros.TransformException:
            return False
        return newest > scan.header.stamp
