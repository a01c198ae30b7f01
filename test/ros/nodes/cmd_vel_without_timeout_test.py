#!/usr/bin/env python3
"""Without a command timeout the last command stays in force."""

import unittest

from commands import Commands
from harness import Robot, distance, run

from aro_robocop_goto_as.geometry import Pose2D


class CmdVelWithoutTimeout(unittest.TestCase):
    def test_a_single_command_stays_in_force_until_the_next_one(self):
        robot, commands = Robot(), Commands()
        commands.once(0.2)
        robot.wait_until_it_drives(0.19)
        start = robot.truth.newest().header.stamp
        robot.truth.wait_for(lambda m: (m.header.stamp - start).to_sec() > 5.0, "5 s more")
        self.assertGreater(robot.truth.newest().twist.twist.linear.x, 0.19)
        self.assertGreater(distance(robot.pose(), Pose2D()), 1.0)
        commands.once(0.0)
        robot.wait_for_standstill()


if __name__ == "__main__":
    run(CmdVelWithoutTimeout)
