#!/usr/bin/env python3
"""The robot stops when its server ends in the middle of a goal, whether killed or interrupted."""

import os
import signal
import unittest

from geometry_msgs.msg import Twist
from harness import Goals, Process, Robot, distance, moves, run, script

TIMEOUT = 0.5  # [s] of cmd_vel
BRAKING = 0.1  # [s] from full speed


class ServerDies(unittest.TestCase):
    def setUp(self):
        self.robot = Robot()
        self.robot.reset()

    def send_distant_goal(self, server):
        """Send a goal far ahead to a new server, and wait until the robot drives at full speed; the goal."""
        goals = Goals()
        goal = goals.send(2.0, 0.0)
        self.robot.wait_until_it_drives(0.19)
        self.assertIsNone(server.process.poll())
        return goal

    def test_robot_stops_after_the_command_timeout_when_its_server_is_killed(self):
        with Process(script("robocop_goto_as.py")) as server:
            goal = self.send_distant_goal(server)
            os.kill(server.pid, signal.SIGKILL)
            self.assertEqual(server.wait_for_exit(), -signal.SIGKILL)
        last_command = self.robot.commands.messages[-1]
        self.assertGreater(last_command.linear.x, 0.0)
        start = self.robot.pose()
        end = self.robot.wait_for_standstill()
        self.assertLess(distance(start, end), 0.22 * (TIMEOUT + BRAKING) + 0.02)
        self.assertEqual(self.robot.commands.messages[-1], last_command)  # no other command stopped it
        self.assertEqual(goal.results(), [])

    def test_interrupted_server_stops_the_robot_and_reports_shutdown(self):
        with Process(script("robocop_goto_as.py")) as server:
            goal = self.send_distant_goal(server)
            server.process.send_signal(signal.SIGINT)
            self.assertEqual(server.wait_for_exit(), 0, server.output)
        self.assertIn("the server is shutting down", goal.result("SHUTDOWN").result.message)
        self.assertFalse(goal.result().result.success)
        self.assertEqual(len(goal.results()), 1)
        end = self.robot.wait_until_it_stands()
        self.assertEqual(self.robot.commands.messages[-1], Twist())
        self.assertFalse(moves(self.robot.truth.next(10)[-1]))
        self.assertLess(distance(end, self.robot.pose()), 0.001)

    def test_a_restarted_server_serves_goals(self):
        with Process(script("robocop_goto_as.py")) as server:
            self.send_distant_goal(server)
            os.kill(server.pid, signal.SIGKILL)
        with Process(script("robocop_goto_as.py")):
            here = self.robot.odom_pose()
            Goals().send(here.x + 0.2, here.y).result("REACHED")


if __name__ == "__main__":
    run(ServerDies)
