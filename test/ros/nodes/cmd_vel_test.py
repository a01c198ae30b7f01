#!/usr/bin/env python3
"""The simulated robot follows the newest command, and brakes after the command timeout."""

import socket
import unittest

from commands import Commands
from harness import Robot, run


class CmdVel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.commands = Commands()

    def setUp(self):
        self.robot.reset()
        self.robot.wait_for_standstill()

    def test_single_command_times_out_after_half_a_second(self):
        self.robot.truth.clear()
        self.commands.once(0.2)
        self.robot.wait_until_it_drives(0.15)
        self.robot.wait_for_standstill()
        stamps = [m.header.stamp.to_sec() for m in self.robot.truth.messages if m.twist.twist.linear.x > 0.1]
        # Faster than half the speed from 0.04 s after the command to 0.04 s after its timeout, sampled at 30 Hz.
        self.assertAlmostEqual(stamps[-1] - stamps[0], 0.5, delta=0.07)

    def test_commands_are_received_without_nagles_delay(self):
        """Also from a publisher that does not set TCP_NODELAY itself."""
        option = self.commands.to_simulator().getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
        self.assertEqual(option, 1)


if __name__ == "__main__":
    run(CmdVel)
