#!/usr/bin/env python3
"""As amcl: map, scan, odom -> base and initialpose -> map -> odom, dated into the future, and amcl_pose.

It asks static_map for the map, looks at scans through a tf message filter, and publishes map -> odom with each scan.
"""

import math
import threading

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import Pose, PoseArray, PoseWithCovarianceStamped, TransformStamped
from nav_msgs.srv import GetMap
from planar import (
    OCCUPIED,
    Grid,
    TransformedScans,
    compose,
    inverse,
    pose_of,
    quaternion,
    returns_of,
    rings,
    wrap,
    yaw_of,
)

PARTICLES = 400
BEAMS = 60  # of each scan
REACH = 10  # cells from an obstacle beyond which all is equally unlikely
SIGMA = 0.1  # [m] of a return's distance from an obstacle of the map
FLOOR = 0.1  # likelihood of a return that fits nothing, over that of one that fits
UPDATE_DISTANCE, UPDATE_ANGLE = 0.1, 0.2  # [m], [rad] of motion between two updates
NOISE = (0.1, 0.1, 0.1)  # of the motion: [m/m], [rad/rad], [rad/m]
PLANAR = np.ix_((0, 1, 5), (0, 1, 5))  # x, y and yaw in a covariance
START = (0.25, 0.25, 0.07)  # variances of x, y [m^2] and yaw [rad^2] at the start, as amcl's


class ParticleFilter:
    """Parameters: ~initial_pose_x, _y, _a [m, m, rad] and ~transform_tolerance [s], as amcl's."""

    def __init__(self):
        rospy.wait_for_service("static_map")
        grid = Grid(rospy.ServiceProxy("static_map", GetMap)().map)
        cells = rings(grid.cells >= OCCUPIED, REACH)
        self._grid = grid
        self._likelihood = np.log(FLOOR + np.exp(-0.5 * (cells * grid.resolution / SIGMA) ** 2))
        self._random = np.random.default_rng(1)
        self._tolerance = rospy.Duration.from_sec(rospy.get_param("~transform_tolerance", 0.1))
        self._lock = threading.Lock()
        self._spread([rospy.get_param(f"~initial_pose_{axis}", 0.0) for axis in "xya"], np.diag(START))
        self._estimate = rospy.Publisher("amcl_pose", PoseWithCovarianceStamped, queue_size=2, latch=True)
        self._cloud = rospy.Publisher("particlecloud", PoseArray, queue_size=2, latch=True)
        self._broadcaster = tf2_ros.TransformBroadcaster()
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        rospy.Subscriber("initialpose", PoseWithCovarianceStamped, self._on_initialpose)
        self._scans = TransformedScans(self._buffer, "scan", "odom", self._on_scan)

    def _spread(self, pose, covariance):
        samples = self._random.multivariate_normal(pose, covariance, PARTICLES)
        self._poses = samples[:, 0], samples[:, 1], wrap(samples[:, 2])
        self._at, self._moved = None, True

    def _on_initialpose(self, message):
        if message.header.frame_id.lstrip("/") != "map":
            rospy.logwarn("ignoring an initial pose in frame %r; expected 'map'", message.header.frame_id)
            return
        pose, covariance = message.pose.pose, np.array(message.pose.covariance).reshape(6, 6)[PLANAR]
        with self._lock:
            self._spread((pose.position.x, pose.position.y, yaw_of(pose.orientation)), covariance)

    def _on_scan(self, scan, odom_from_scan):
        stamp = scan.header.stamp
        odom_from_base = pose_of(self._buffer.lookup_transform("odom", "base_footprint", stamp))
        base_from_scan = compose(inverse(odom_from_base), odom_from_scan)
        with self._lock:
            self._move(odom_from_base)
            if self._moved:
                self._moved = False
                self._weigh(scan, base_from_scan)
                self._publish_estimate(stamp)
            self._publish_transform(odom_from_base, stamp + self._tolerance)

    def _move(self, odom_from_base):
        if self._at is None:
            self._at = odom_from_base
            return
        x, y, turn = compose(inverse(self._at), odom_from_base)
        distance = math.hypot(x, y)
        if distance < UPDATE_DISTANCE and abs(turn) < UPDATE_ANGLE:
            return
        self._at, self._moved = odom_from_base, True
        noise = self._random.normal(size=(3, PARTICLES))
        self._poses = compose(
            self._poses,
            (
                x + NOISE[0] * distance * noise[0],
                y + NOISE[0] * distance * noise[1],
                turn + (NOISE[1] * abs(turn) + NOISE[2] * distance) * noise[2],
            ),
        )

    def _weigh(self, scan, base_from_scan):
        hit, x, y = returns_of(scan)
        chosen = np.flatnonzero(hit)
        if not len(chosen):
            return
        chosen = chosen[:: max(1, len(chosen) // BEAMS)]
        scanners = compose(self._poses, base_from_scan)
        ends = compose([value[:, None] for value in scanners], (x[chosen], y[chosen], 0.0))
        log = self._likelihood[self._grid.cells_at(ends[0], ends[1])].sum(axis=1) * 0.3  # beams are not independent
        weights = np.exp(log - log.max())
        picks = np.searchsorted(
            np.cumsum(weights / weights.sum()), (np.arange(PARTICLES) + self._random.random()) / PARTICLES
        )
        self._poses = tuple(values[np.minimum(picks, PARTICLES - 1)] for values in self._poses)

    def _mean(self):
        x, y, yaw = self._poses
        return x.mean(), y.mean(), math.atan2(np.sin(yaw).mean(), np.cos(yaw).mean())

    def _publish_estimate(self, stamp):
        message, cloud = PoseWithCovarianceStamped(), PoseArray()
        message.header.stamp = cloud.header.stamp = stamp
        message.header.frame_id = cloud.header.frame_id = "map"
        x, y, yaw = self._mean()
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.pose.pose.orientation = quaternion(yaw)
        covariance = np.zeros((6, 6))
        deviations = (self._poses[0] - x, self._poses[1] - y, wrap(self._poses[2] - yaw))
        covariance[PLANAR] = np.cov(deviations)
        message.pose.covariance = covariance.ravel().tolist()
        for x, y, yaw in zip(*self._poses):
            cloud.poses.append(Pose(orientation=quaternion(yaw)))
            cloud.poses[-1].position.x, cloud.poses[-1].position.y = x, y
        self._estimate.publish(message)
        self._cloud.publish(cloud)

    def _publish_transform(self, odom_from_base, stamp):
        at = odom_from_base if self._at is None else self._at  # where the odometry was at the last update
        made = TransformStamped()
        made.header.frame_id, made.header.stamp, made.child_frame_id = "map", stamp, "odom"
        x, y, yaw = compose(self._mean(), inverse(at))
        made.transform.translation.x, made.transform.translation.y = x, y
        made.transform.rotation = quaternion(yaw)
        self._broadcaster.sendTransform(made)


if __name__ == "__main__":
    rospy.init_node("particle_filter")
    ParticleFilter()
    rospy.spin()
