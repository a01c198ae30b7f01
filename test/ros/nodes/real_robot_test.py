#!/usr/bin/env python3
"""profile:=real: two robots of different models, each with the topics, covariances and frames of a real one."""

import unittest

import rospy
from harness import SIMULATOR, Recorder, Robot, run, wait_for
from sensor_msgs.msg import Imu
from tf2_msgs.msg import TFMessage


class RealRobot(unittest.TestCase):
    def test_covariances_are_those_of_the_firmware(self):
        odom = Robot("red").odom.newest()
        self.assertEqual(set(odom.pose.covariance + odom.twist.covariance), {0.0})
        imu = Recorder("red/imu", Imu).newest()
        self.assertEqual(
            [imu.orientation_covariance[0], imu.angular_velocity_covariance[4], imu.linear_acceleration_covariance[8]],
            [0.0025, 0.02, 0.04],
        )

    def test_a_burger_has_no_bumper(self):
        self.assertNotIn("/red/bumper", dict(rospy.get_published_topics()))

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
