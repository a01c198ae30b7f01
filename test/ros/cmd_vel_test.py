#!/usr/bin/env python3
"""The simulated robot obeys the newest sensible command, and brakes when none comes any more."""

import math
import socket
import unittest

from commands import Commands
from harness import SIMULATOR, Recorder, Robot, moves, run
from rosgraph_msgs.msg import Log


class CmdVel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.commands = Commands()
        cls.log = Recorder("/rosout", Log, wait=False)

    def setUp(self):
        self.robot.reset()
        self.robot.wait_for_standstill()
        self.log.forget()

    def test_single_command_times_out_after_half_a_second(self):
        self.robot.truth.forget()
        self.commands.once(0.2)
        self.robot.wait_until_it_drives(0.15)
        self.robot.wait_for_standstill()
        stamps = [m.header.stamp.to_sec() for m in self.robot.truth.messages if m.twist.twist.linear.x > 0.1]
        # Above half the speed from 0.04 s after the command to 0.04 s after its time-out, seen 30 times a second.
        self.assertAlmostEqual(stamps[-1] - stamps[0], 0.5, delta=0.07)

    def test_commands_are_not_held_back_on_their_way_to_be_sent_together(self):
        """For a publisher that does not ask for it itself."""
        option = self.commands.to_simulator().getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
        self.assertEqual(option, 1)

    def test_newest_command_wins(self):
        for i in range(20):
            self.commands.once(0.0, 0.1 * i)
        with self.commands.held(-0.1):
            start = len(self.robot.truth)
            self.robot.truth.wait_for(lambda m: m.twist.twist.linear.x < -0.09 and abs(m.twist.twist.angular.z) < 0.05,
                                      "a robot that drives back", start)
        self.robot.wait_for_standstill()

    def test_command_beyond_the_limits_is_clamped_to_them(self):
        with self.commands.held(5.0):
            self.robot.wait_until_it_drives(0.2)
            fast = self.robot.truth.take(15)
        self.assertLess(max(m.twist.twist.linear.x for m in fast), 0.23)
        self.robot.wait_for_standstill()

    def test_command_of_nan_or_infinity_is_refused_and_the_one_before_stays_in_force(self):
        bad = ((math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.0, -math.inf))
        with self.commands.held(0.1):
            self.robot.wait_until_it_drives(0.09)
            for v, w in bad * 5:
                self.commands.once(v, w)
                for m in self.robot.truth.take(2):
                    self.assertAlmostEqual(m.twist.twist.linear.x, 0.1, delta=0.02)
                    self.assertAlmostEqual(m.twist.twist.angular.z, 0.0, delta=0.05)
        self.robot.wait_for_standstill()
        for v, w in bad:
            self.commands.once(v, w)
            self.assertFalse([m for m in self.robot.truth.take(3) if moves(m)])
        self.log.wait_for(lambda m: m.name == SIMULATOR and m.level == Log.WARN and "nan m/s" in m.msg
                          and "expected finite numbers" in m.msg, "a warning")
        refusals = [m for m in self.log.messages if "velocity command refused" in m.msg]
        self.assertLess(len(refusals), 10)  # of 24: the warning is throttled


if __name__ == "__main__":
    run(CmdVel)
