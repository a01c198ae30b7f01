"""A navigation stack at its interfaces: amcl's map -> odom, a costmap's scans in map, commands of move_base."""

import math
import unittest

import numpy as np
import ros_numpy
import rospy
import tf2_ros
from aro_robocop_goto_as.msg import SimStatus
from geometry_msgs.msg import Transform, TransformStamped, Twist, Vector3
from harness import DEADLINE, SIMULATOR, Recorder, Robot, distance, wait_for, wait_for_subscriber
from nav_msgs.srv import GetMap
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle
from aro_robocop_goto_as.ros.convert import to_quaternion

RATE = 20.0  # [Hz] move_base's controller_frequency
WAY = ((-0.55, -0.55), (0.55, -0.55), (0.55, 0.55))  # in map [m], between the pillars of the world
REACHED = 0.1  # [m]
DRIFT = 0.05  # [m] of odometry on this way


class Navigation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot, cls.scan = Robot(), Recorder("scan", LaserScan)
        spawn = cls.robot.pose()
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        at = Transform(Vector3(spawn.x, spawn.y, 0.0), to_quaternion(spawn.yaw))
        cls.broadcaster.sendTransform(TransformStamped(Header(0, rospy.Time.now(), "map"), "odom", at))
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        wait_for_subscriber(cls.commands, SIMULATOR)
        rospy.wait_for_service("static_map", DEADLINE)
        cls.map = rospy.ServiceProxy("static_map", GetMap)().map

    def pose_in_map(self, frame, stamp):
        """The pose of a frame in map at a time; the newest for time zero."""
        wait_for(lambda: self.buffer.can_transform("map", frame, stamp), f"{frame} in map at {stamp}")
        at = self.buffer.lookup_transform("map", frame, stamp).transform
        return Pose2D(at.translation.x, at.translation.y, 2.0 * math.atan2(at.rotation.z, at.rotation.w))

    def cells_at(self, x, y):
        """Occupancy of the map at points [m]."""
        info = self.map.info
        columns = np.floor((x - info.origin.position.x) / info.resolution).astype(int)
        rows = np.floor((y - info.origin.position.y) / info.resolution).astype(int)
        return ros_numpy.numpify(self.map).data[rows, columns]

    def assert_scan_matches_map(self):
        """The returns of the next scan, at the pose of its stamp, lie on occupied cells or beside one."""
        scan = self.scan.next()[0]
        scanner = self.pose_in_map(scan.header.frame_id, scan.header.stamp)
        ranges = np.array(scan.ranges)
        hit = np.isfinite(ranges)
        angles = scanner.yaw + scan.angle_min + scan.angle_increment * np.arange(len(ranges))[hit]
        x, y = scanner.x + ranges[hit] * np.cos(angles), scanner.y + ranges[hit] * np.sin(angles)
        near = [self.cells_at(x + dx, y + dy) for dx in (-DRIFT, 0.0, DRIFT) for dy in (-DRIFT, 0.0, DRIFT)]
        self.assertGreater((np.max(near, axis=0) == 100).mean(), 0.95)

    def command_towards(self, x, y):
        """Publish the command of one period; False once the point is reached."""
        at = self.pose_in_map("base_footprint", rospy.Time(0))
        if distance(at, Pose2D(x, y)) < REACHED:
            return False
        error = wrap_angle(math.atan2(y - at.y, x - at.x) - at.yaw)
        twist = Twist()
        twist.angular.z = max(-1.0, min(1.0, 2.0 * error))
        twist.linear.x = 0.2 if abs(error) < 0.3 else 0.0
        self.commands.publish(twist)
        return True

    def test_planner_is_waited_for_and_drives_by_map_scans_and_transforms(self):
        at = self.robot.pose()
        self.assertEqual(self.cells_at(at.x, at.y), 0)
        self.assert_scan_matches_map()
        status, rate = Recorder(f"{SIMULATOR}/status", SimStatus), rospy.Rate(RATE)
        status.next()
        for point in WAY:
            while self.command_towards(*point):
                rate.sleep()
        drivers = [driver for driver in status.messages[-1].drivers if driver.startswith(rospy.get_name())]
        self.assertEqual((len(drivers), status.messages[-1].lockstep_misses), (1, 0), status.messages[-1])
        self.commands.publish(Twist())
        end = self.robot.wait_until_it_stands()
        self.assertLess(distance(end, Pose2D(*WAY[-1])), REACHED + DRIFT)
        self.assert_scan_matches_map()
