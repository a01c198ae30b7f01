#!/usr/bin/env python3
"""profile:=real: two robots of different models, each with the topics, limits and timeout of a real one."""

import unittest

import rospy
from commands import Commands
from harness import SIMULATOR, Recorder, Robot, run, wait_for
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage

TICK = 0.001533981  # [rad]


class RealRobot(unittest.TestCase):
    def test_covariances_are_those_of_the_firmware(self):
        odom = Robot("red").odom.newest()
        self.assertEqual(set(odom.pose.covariance + odom.twist.covariance), {0.0})
        imu = Recorder("red/imu", Imu).newest()
        self.assertEqual(
            [imu.orientation_covariance[0], imu.angular_velocity_covariance[4], imu.linear_acceleration_covariance[8]],
            [0.0025, 0.02, 0.04],
        )

    def test_scan_is_that_of_an_lds01(self):
        scan = Recorder("red/scan", LaserScan).newest()
        self.assertAlmostEqual(scan.range_max, 3.5, places=5)
        self.assertEqual(len(scan.ranges), 360)
        self.assertTrue(all(r == 0.0 or 0.12 <= r < 3.51 for r in scan.ranges))

    def test_a_burger_has_no_bumper(self):
        self.assertNotIn("/red/bumper", dict(rospy.get_published_topics()))

    def test_joint_positions_are_whole_encoder_ticks(self):
        for position in Recorder("blue/joint_states", JointState).newest().position:
            self.assertAlmostEqual(position / TICK, round(position / TICK), places=6)

    def test_burger_is_limited_by_its_firmware_and_brakes_after_half_a_second(self):
        robot, commands = Robot("red"), Commands("red/cmd_vel")
        commands.once(5.0)
        robot.wait_until_it_drives(0.2)
        robot.wait_for_standstill()
        fast = [m.header.stamp.to_sec() for m in robot.truth.messages if m.twist.twist.linear.x > 0.105]
        self.assertAlmostEqual(fast[-1] - fast[0], 0.5, delta=0.07)
        self.assertLess(max(m.twist.twist.linear.x for m in robot.truth.messages), 0.214)

    def test_each_robot_has_the_description_and_the_frames_of_its_own_model(self):
        self.assertIn('name="turtlebot2"', rospy.get_param("/blue/robot_description"))
        self.assertIn('name="turtlebot3_burger"', rospy.get_param("/red/robot_description"))
        static = Recorder("/tf_static", TFMessage)

        def scanners():
            found = {t.child_frame_id: t.transform.translation for m in static.messages for t in m.transforms}
            return [found.get("red/base_scan"), found.get("blue/base_scan")]

        wait_for(lambda: all(scanners()), "both scanners on /tf_static")
        red, blue = scanners()
        self.assertEqual((red.x, red.z, blue.x, blue.z), (-0.032, 0.172, 0.0, 0.150))
        self.assertTrue(rospy.get_param(f"{SIMULATOR}/encoder_tick"))


if __name__ == "__main__":
    run(RealRobot)
