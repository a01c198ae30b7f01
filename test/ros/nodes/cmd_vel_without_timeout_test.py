#!/usr/bin/env python3
"""Without a command timeout the last valid command stays in force."""

import math
import unittest

from commands import Commands
from harness import SIMULATOR, Recorder, Robot, distance, run, wait_for_connection
from rosgraph_msgs.msg import Log

from aro_robocop_goto_as.geometry import Pose2D


class CmdVelWithoutTimeout(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot, cls.commands = Robot(), Commands()
        cls.log = Recorder("/rosout", Log, wait=False)
        wait_for_connection(SIMULATOR, "/rosout")

    def setUp(self):
        self.robot.reset()

    def test_a_single_command_stays_in_force_until_the_next_one(self):
        robot, commands = self.robot, self.commands
        commands.once(0.2)
        robot.wait_until_it_drives(0.19)
        start = robot.truth.newest().header.stamp
        robot.truth.wait_for(lambda m: (m.header.stamp - start).to_sec() > 5.0, "5 s more")
        self.assertGreater(robot.truth.newest().twist.twist.linear.x, 0.19)
        self.assertGreater(distance(robot.odom_pose(), Pose2D()), 1.0)
        commands.once(0.0)
        robot.wait_for_standstill()

    def test_a_command_of_nan_or_infinity_is_refused_and_the_one_before_stays_in_force(self):
        bad = ((math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.0, -math.inf))
        self.commands.once(0.1)
        self.robot.wait_until_it_drives(0.09)
        for v, w in bad:
            self.commands.once(v, w)
            for m in self.robot.truth.next(2):
                self.assertAlmostEqual(m.twist.twist.linear.x, 0.1, delta=0.02)
                self.assertAlmostEqual(m.twist.twist.angular.z, 0.0, delta=0.05)
        self.commands.once(0.0)
        self.robot.wait_for_standstill()
        self.log.wait_for(
            lambda m: (
                m.name == SIMULATOR
                and m.level == Log.WARN
                and "nan m/s" in m.msg
                and "expected finite numbers" in m.msg
            ),
            "a warning",
        )


if __name__ == "__main__":
    run(CmdVelWithoutTimeout)
