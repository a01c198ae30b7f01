"""profile:=real: the covariances of a real robot."""

import unittest

from harness import Recorder, Robot
from sensor_msgs.msg import Imu


class RealRobot(unittest.TestCase):
    def test_covariances_are_those_of_the_firmware(self):
        odom = Robot("red").odom.newest()
        self.assertEqual(set(odom.pose.covariance + odom.twist.covariance), {0.0})
        imu = Recorder("red/imu", Imu).newest()
        self.assertEqual(
            [imu.orientation_covariance[0], imu.angular_velocity_covariance[4], imu.linear_acceleration_covariance[8]],
            [0.0025, 0.02, 0.04],
        )
