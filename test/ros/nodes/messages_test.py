#!/usr/bin/env python3
"""Every message follows REP-103 (units, axes) and REP-105 (frames)."""

import math
import unittest

import numpy as np
import rospy
import tf2_ros
from commands import Commands
from harness import Recorder, Robot, distance, run, wait_for
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan
from systems import Process
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle
from aro_robocop_goto_as.ros.connected_nodes import sender
from aro_robocop_goto_as.ros.convert import from_pose_msg

SPAWN = Pose2D(-0.7, 0.0)  # of the default world
WHEEL_RADIUS, WHEEL_SEPARATION = 0.033, 0.160  # [m] TurtleBot3 Burger
SCANNER = (-0.032, 0.0, 0.182)  # [m] base_scan in base_footprint: .010 to base_link, .172 above it
GRAVITY = 9.80665  # [m/s^2]


def norm(quaternion):
    """The norm of a quaternion message: 1 for a rotation."""
    return math.sqrt(quaternion.x**2 + quaternion.y**2 + quaternion.z**2 + quaternion.w**2)


def stamp_of(message):
    """The stamp of a message [ns]."""
    return message.header.stamp.to_nsec()


def transforms(recorder, child):
    """All transforms to a child frame that were received on a TF topic."""
    return [t for m in recorder.messages for t in m.transforms if t.child_frame_id == child]


class Messages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.commands = Commands()
        cls.scan = Recorder("scan", LaserScan)
        cls.imu = Recorder("imu", Imu)
        cls.joints = Recorder("joint_states", JointState)
        cls.tf = Recorder("/tf", TFMessage)
        cls.tf_static = Recorder("/tf_static", TFMessage)
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        # Cleared in this order, so that whatever is published with a scan or odometry message is kept if that one is.
        cls.recorders = (cls.imu, cls.joints, cls.tf, cls.robot.truth, cls.robot.odom, cls.scan)

    def setUp(self):
        self.robot.reset()
        self.clear()

    def clear(self):
        """Drop the messages received so far."""
        for recorder in self.recorders:
            recorder.clear()

    def drive_an_arc(self):
        """Record only a motion at constant speed: 0.15 m/s forward, 0.5 rad/s to the left; it goes on after that."""
        self.addCleanup(self.stop)
        self.commands.once(0.15, 0.5)
        full = self.robot.truth.wait_for(
            lambda m: m.twist.twist.linear.x > 0.149 and m.twist.twist.angular.z > 0.49, "the full speed"
        )
        begin = stamp_of(full) + 100_000_000
        end = begin + 1_000_000_000
        for recorder in (self.imu, self.joints, self.robot.truth, self.robot.odom, self.scan):
            recorder.wait_for(lambda m: stamp_of(m) > end, "a second of messages")
            del recorder.messages[: sum(stamp_of(m) <= begin for m in recorder.messages)]

    def stop(self):
        """End the motion."""
        self.commands.once(0.0)
        self.robot.wait_for_standstill()

    def test_odometry_ground_truth_scan_and_imu_are_in_their_frames_with_covariances(self):
        for recorder, frame in ((self.robot.odom, "odom"), (self.robot.truth, "world")):
            message = recorder.newest()
            self.assertEqual((message.header.frame_id, message.child_frame_id), (frame, "base_footprint"))
            self.assert_valid_covariances(message)
        imu = self.imu.newest()
        for covariance in (
            imu.orientation_covariance,
            imu.angular_velocity_covariance,
            imu.linear_acceleration_covariance,
        ):
            self.assertTrue((np.diag(np.array(covariance).reshape(3, 3)) > 0.0).all())
        self.assertEqual((self.scan.newest().header.frame_id, imu.header.frame_id), ("base_scan", "imu_link"))

    def assert_valid_covariances(self, odometry: Odometry):
        """Covariances are symmetric with positive variances; the orientation is a unit quaternion."""
        self.assertAlmostEqual(norm(odometry.pose.pose.orientation), 1.0, places=6)
        self.assertEqual(odometry.pose.pose.position.z, 0.0)
        for covariance in (odometry.pose.covariance, odometry.twist.covariance):
            matrix = np.array(covariance).reshape(6, 6)
            self.assertTrue((matrix == matrix.T).all())
            self.assertTrue((np.diag(matrix) > 0.0).all())

    def test_twist_of_odometry_and_ground_truth_is_in_the_child_frame_and_matches_the_motion(self):
        self.drive_an_arc()
        for messages in (self.robot.odom.messages, self.robot.truth.messages):
            self.assertGreater(len(messages), 10)
            for before, after in zip(messages, messages[1:]):
                a, b = from_pose_msg(before.pose.pose), from_pose_msg(after.pose.pose)
                dt = (stamp_of(after) - stamp_of(before)) * 1e-9
                way = math.atan2(b.y - a.y, b.x - a.x)
                twist = after.twist.twist
                self.assertAlmostEqual(wrap_angle(way - a.yaw), 0.5 * dt / 2.0, delta=0.02)  # ahead, not sideways
                self.assertAlmostEqual(twist.linear.x, distance(a, b) / dt, delta=0.005)
                self.assertAlmostEqual(twist.angular.z, wrap_angle(b.yaw - a.yaw) / dt, delta=0.03)
                self.assertEqual((twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y), (0.0,) * 4)

    def test_joint_states_contain_both_wheels_and_match_odometry(self):
        self.drive_an_arc()
        odometry = {stamp_of(m): m.twist.twist for m in self.robot.odom.messages}
        compared = 0
        for joints in self.joints.messages:
            self.assertEqual(joints.name, ["wheel_left_joint", "wheel_right_joint"])
            self.assertEqual((len(joints.position), len(joints.velocity)), (2, 2))
            twist = odometry.get(stamp_of(joints))
            if twist is not None:
                left, right = (WHEEL_RADIUS * velocity for velocity in joints.velocity)
                self.assertAlmostEqual((left + right) / 2.0, twist.linear.x, delta=0.01)
                self.assertAlmostEqual((right - left) / WHEEL_SEPARATION, twist.angular.z, delta=0.05)
                compared += 1
        self.assertGreater(compared, 10)

    def test_imu_measures_gravity_upwards_and_the_turn_to_the_left(self):
        self.drive_an_arc()
        self.assertAlmostEqual(np.mean([m.linear_acceleration.z for m in self.imu.messages]), GRAVITY, delta=0.1)
        self.assertAlmostEqual(np.mean([m.angular_velocity.z for m in self.imu.messages]), 0.5, delta=0.02)

    def test_all_messages_of_one_step_carry_the_same_stamp(self):
        self.drive_an_arc()
        scans = {stamp_of(m) for m in self.scan.messages[1:-1]}
        self.assertGreater(len(scans), 4)
        for recorder in (self.robot.odom, self.robot.truth, self.joints):
            recorder.wait_for(lambda m: stamp_of(m) > max(scans), "a message later than the scans")
            self.assertLessEqual(scans, {stamp_of(m) for m in recorder.messages}, recorder.topic)
        odometry = self.robot.odom.messages[1:]
        wait_for(lambda: stamp_of(transforms(self.tf, "base_footprint")[-1]) >= stamp_of(odometry[-1]), "TF that late")
        poses = {stamp_of(t): t.transform for t in transforms(self.tf, "base_footprint")}
        self.assertLessEqual(scans, set(poses))
        for odom in odometry:
            transform = poses[stamp_of(odom)]
            self.assertEqual(
                (transform.translation.x, transform.translation.y),
                (odom.pose.pose.position.x, odom.pose.pose.position.y),
            )
            self.assertEqual(transform.rotation, odom.pose.pose.orientation)

    def test_another_robot_state_publisher_does_not_replace_that_of_the_simulator(self):
        with Process("rosrun", "robot_state_publisher", "robot_state_publisher"):
            for node in ("/robot_state_publisher", "/robocop_state_publisher"):
                start = len(self.tf)
                self.tf.wait_for(
                    lambda m, node=node: (
                        sender(m) == node and any(t.child_frame_id == "wheel_left_link" for t in m.transforms)
                    ),
                    f"the transform of a wheel from {node}",
                    start,
                )

    def test_tf_is_one_tree_from_map_through_odom_and_base_footprint_to_base_scan(self):
        self.joints.next(5)
        wait_for(
            lambda: (
                self.buffer.can_transform("map", "base_scan", rospy.Time(0))
                and self.buffer.can_transform("map", "wheel_left_link", rospy.Time(0))
            ),
            "transforms from map",
        )
        parents = {}
        for recorder in (self.tf, self.tf_static):
            for message in recorder.messages:
                for t in message.transforms:
                    self.assertAlmostEqual(norm(t.transform.rotation), 1.0, places=6)
                    self.assertEqual(parents.setdefault(t.child_frame_id, t.header.frame_id), t.header.frame_id)
        chain = ["base_scan"]
        while chain[-1] in parents:
            chain.append(parents[chain[-1]])
        self.assertEqual(chain, ["base_scan", "base_link", "base_footprint", "odom", "map", "world"])
        self.assertEqual(parents["imu_link"], "base_link")
        at = self.buffer.lookup_transform("base_footprint", "base_scan", rospy.Time(0)).transform.translation
        np.testing.assert_allclose((at.x, at.y, at.z), SCANNER, atol=1e-6)
        at = self.buffer.lookup_transform("map", "odom", rospy.Time(0)).transform.translation
        np.testing.assert_allclose((at.x, at.y, at.z), (SPAWN.x, SPAWN.y, 0.0), atol=1e-9)


if __name__ == "__main__":
    run(Messages)
