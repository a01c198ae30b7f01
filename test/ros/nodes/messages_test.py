"""Every message follows REP-103 (units, axes) and REP-105 (frames); commands arrive at once, or are refused."""

import math
import socket
import unittest

import numpy as np
import rospy
import tf2_ros
from aro_robocop_goto_as.msg import SimStatus
from geometry_msgs.msg import Twist, Vector3
from harness import SIMULATOR, Recorder, Robot, distance, wait_for, wait_for_connection, wait_for_subscriber
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle
from aro_robocop_goto_as.ros.convert import from_pose_msg

SPAWN = Pose2D(-0.7, 0.0)  # of the default world
SPEED, TURN = 0.15, 0.5  # [m/s], [rad/s] forward and to the left
WHEEL_RADIUS, WHEEL_SEPARATION = 0.033, 0.160  # [m] TurtleBot3 Burger
SCANNER = (-0.032, 0.0, 0.182)  # [m] base_scan in base_footprint: .010 to base_link, .172 above it
GRAVITY = 9.80665  # [m/s^2]


def norm(quaternion):
    """The norm of a quaternion message: 1 for a rotation."""
    return math.sqrt(quaternion.x**2 + quaternion.y**2 + quaternion.z**2 + quaternion.w**2)


def stamp_of(message):
    """The stamp of a message [ns]."""
    return message.header.stamp.to_nsec()


class SimulatorTest(unittest.TestCase):
    """A robot that one command keeps at the same speed."""

    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.topic = rospy.Publisher("cmd_vel", Twist, queue_size=10)
        wait_for_subscriber(cls.topic, SIMULATOR)
        cls.robot.reset()

    @classmethod
    def command(cls, v, w=0.0):
        """Publish one command [m/s, rad/s]."""
        cls.topic.publish(Twist(Vector3(v, 0.0, 0.0), Vector3(0.0, 0.0, w)))

    @classmethod
    def tearDownClass(cls):
        cls.command(0.0)
        cls.robot.wait_for_standstill()


class Messages(SimulatorTest):
    """Messages of one second of a drive along an arc at constant speed."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        kinds = {"imu": Imu, "joint_states": JointState, "scan": LaserScan}
        recorders = [cls.robot.odom, cls.robot.truth, *(Recorder(topic, kind) for topic, kind in kinds.items())]
        cls.tf, cls.tf_static = Recorder("/tf", TFMessage), Recorder("/tf_static", TFMessage)
        cls.command(SPEED, TURN)
        full = cls.robot.truth.wait_for(
            lambda m: m.twist.twist.linear.x > 0.149 and m.twist.twist.angular.z > 0.49, "the full speed"
        )
        begin = stamp_of(full) + 100_000_000
        end = begin + 1_000_000_000
        for recorder in recorders:
            recorder.wait_for(lambda m: stamp_of(m) > end, "a second of messages")
        cls.odom, cls.truth, cls.imu, cls.joints, cls.scan = (
            [m for m in recorder.messages if begin < stamp_of(m) <= end] for recorder in recorders
        )
        wait_for(lambda: "wheel_left_link" in {t.child_frame_id for t in cls.transforms()}, "the wheels' transforms")
        cls.tf.wait_for(
            lambda m: any(t.child_frame_id == "base_footprint" and stamp_of(t) > end for t in m.transforms), "TF"
        )

    @classmethod
    def transforms(cls):
        """All transforms that were received."""
        return [t for recorder in (cls.tf, cls.tf_static) for m in recorder.messages for t in m.transforms]

    def test_odometry_ground_truth_scan_and_imu_are_in_their_frames_with_covariances(self):
        for message, frame in ((self.odom[0], "odom"), (self.truth[0], "world")):
            self.assertEqual((message.header.frame_id, message.child_frame_id), (frame, "base_footprint"))
            self.assert_valid_covariances(message)
        imu = self.imu[0]
        for covariance in (
            imu.orientation_covariance,
            imu.angular_velocity_covariance,
            imu.linear_acceleration_covariance,
        ):
            self.assertTrue((np.diag(np.array(covariance).reshape(3, 3)) > 0.0).all())
        self.assertEqual((self.scan[0].header.frame_id, imu.header.frame_id), ("base_scan", "imu_link"))

    def assert_valid_covariances(self, odometry: Odometry):
        """Covariances are symmetric with positive variances; the orientation is a unit quaternion."""
        self.assertAlmostEqual(norm(odometry.pose.pose.orientation), 1.0, places=6)
        self.assertEqual(odometry.pose.pose.position.z, 0.0)
        for covariance in (odometry.pose.covariance, odometry.twist.covariance):
            matrix = np.array(covariance).reshape(6, 6)
            self.assertTrue((matrix == matrix.T).all())
            self.assertTrue((np.diag(matrix) > 0.0).all())

    def test_twist_of_odometry_and_ground_truth_is_in_the_child_frame_and_matches_the_motion(self):
        for messages in (self.odom, self.truth):
            self.assertGreater(len(messages), 10)
            for before, after in zip(messages, messages[1:]):
                a, b = from_pose_msg(before.pose.pose), from_pose_msg(after.pose.pose)
                dt = (stamp_of(after) - stamp_of(before)) * 1e-9
                way = math.atan2(b.y - a.y, b.x - a.x)
                twist = after.twist.twist
                self.assertAlmostEqual(wrap_angle(way - a.yaw), TURN * dt / 2.0, delta=0.02)  # ahead, not sideways
                self.assertAlmostEqual(twist.linear.x, distance(a, b) / dt, delta=0.005)
                self.assertAlmostEqual(twist.angular.z, wrap_angle(b.yaw - a.yaw) / dt, delta=0.03)
                self.assertEqual((twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y), (0.0,) * 4)

    def test_joint_states_contain_both_wheels_and_match_odometry(self):
        odometry = {stamp_of(m): m.twist.twist for m in self.odom}
        compared = 0
        for joints in self.joints:
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
        self.assertAlmostEqual(np.mean([m.linear_acceleration.z for m in self.imu]), GRAVITY, delta=0.1)
        self.assertAlmostEqual(np.mean([m.angular_velocity.z for m in self.imu]), TURN, delta=0.02)

    def test_all_messages_of_one_step_carry_the_same_stamp(self):
        scans = {stamp_of(m) for m in self.scan}
        self.assertGreater(len(scans), 4)
        for messages in (self.odom, self.truth, self.joints):
            self.assertLessEqual(scans, {stamp_of(m) for m in messages})
        poses = {stamp_of(t): t.transform for t in self.transforms() if t.child_frame_id == "base_footprint"}
        for odom in self.odom:
            transform = poses[stamp_of(odom)]
            self.assertEqual(
                (transform.translation.x, transform.translation.y),
                (odom.pose.pose.position.x, odom.pose.pose.position.y),
            )
            self.assertEqual(transform.rotation, odom.pose.pose.orientation)

    def test_tf_is_one_tree_from_map_through_odom_and_base_footprint_to_base_scan(self):
        parents, buffer = {}, tf2_ros.Buffer()
        for t in self.transforms():
            self.assertAlmostEqual(norm(t.transform.rotation), 1.0, places=6)
            self.assertEqual(parents.setdefault(t.child_frame_id, t.header.frame_id), t.header.frame_id)
            buffer.set_transform_static(t, "test")
        chain = ["base_scan"]
        while chain[-1] in parents:
            chain.append(parents[chain[-1]])
        self.assertEqual(chain, ["base_scan", "base_link", "base_footprint", "odom", "map", "world"])
        self.assertEqual((parents["imu_link"], parents["wheel_left_link"]), ("base_link", "base_link"))
        at = buffer.lookup_transform("base_footprint", "base_scan", rospy.Time(0)).transform.translation
        np.testing.assert_allclose((at.x, at.y, at.z), SCANNER, atol=1e-6)
        at = buffer.lookup_transform("map", "odom", rospy.Time(0)).transform.translation
        np.testing.assert_allclose((at.x, at.y, at.z), (SPAWN.x, SPAWN.y, 0.0), atol=1e-9)


class Commands(SimulatorTest):
    def test_a_command_of_nan_or_infinity_is_refused_and_the_one_before_stays_in_force(self):
        log = Recorder("/rosout", Log, wait=False)
        wait_for_connection(SIMULATOR, "/rosout")
        self.command(0.1)
        self.robot.wait_until_it_drives(0.09)
        for v, w in ((math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.0, -math.inf)):
            self.command(v, w)
            for m in self.robot.truth.next(2):
                self.assertAlmostEqual(m.twist.twist.linear.x, 0.1, delta=0.02)
                self.assertAlmostEqual(m.twist.twist.angular.z, 0.0, delta=0.05)
        refused = "linear.x nan m/s, angular.z 0.0 rad/s; expected finite numbers"
        log.wait_for(lambda m: (m.name, m.level) == (SIMULATOR, Log.WARN) and refused in m.msg, "a warning")

    def test_commands_are_received_without_nagles_delay_also_from_a_publisher_that_does_not_ask_for_it(self):
        (connected,) = [c.socket for c in self.topic.impl.connections if c.endpoint_id == SIMULATOR]
        self.assertEqual(connected.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY), 1)

    def test_a_robot_whose_wheels_slip_at_an_obstacle_is_reported_until_a_reset(self):
        log, status = Recorder("/rosout", Log, wait=False), Recorder(f"{SIMULATOR}/status", SimStatus)
        wait_for_connection(SIMULATOR, "/rosout")
        self.command(0.2)
        status.wait_for(lambda m: m.slipped == [""], "the slip")
        log.wait_for(lambda m: "the wheels slipped at an obstacle: odometry is 0." in m.msg, "a warning")
        self.command(0.0)
        self.robot.reset()
        status.wait_for(lambda m: m.slipped == [], "the end of the slip", len(status))
