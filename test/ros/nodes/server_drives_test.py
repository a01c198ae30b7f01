#!/usr/bin/env python3
"""The control loop of the handout on its topics: commands for given errors, and what counts as an obstacle."""

import math
import unittest

from fake_robot import FakeRobot
from geometry_msgs.msg import Twist
from harness import run

AHEAD = range(-31, 32)  # [degrees]


class ServerDrives(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = FakeRobot()

    def setUp(self):
        self.robot.renew()

    def tearDown(self):
        self.robot.goals.assert_each_ended_once()

    def run_goal(self, x, y, word="REACHED"):
        """Send a goal and follow it to its end, which has this outcome; the goal."""
        goal = self.robot.start(x, y)
        self.robot.follow(goal)
        self.robot.end(goal, word)
        return goal

    def test_robot_does_not_drive_while_it_faces_away_and_does_not_turn_while_it_drives(self):
        goal = self.run_goal(-0.5, 0.7)
        answers = [(m.feedback, c) for m, c in zip(goal.feedback(), self.robot.commands.messages)]
        self.assertGreater(len(answers), 30)
        for feedback, command in answers[:-1]:
            if abs(feedback.angle_error) > 0.1:
                self.assertEqual(command.linear.x, 0.0)
                self.assertGreater(command.angular.z * feedback.angle_error, 0.0)
            else:
                self.assertEqual(command.angular.z, 0.0)
                self.assertGreater(command.linear.x, 0.0)

    def test_feedback_is_published_every_control_period_with_the_errors(self):
        goal = self.run_goal(0.3, -0.4)
        # The result may arrive before the feedback that was sent first: these are two connections.
        goal.wait_for_feedback(lambda feedback: feedback.position_error < 0.1, "the feedback at the goal")
        stamps = [m.header.stamp.to_sec() for m in goal.feedback()]
        for a, b in zip(stamps, stamps[1:]):
            self.assertAlmostEqual(b - a, 0.1, places=6)
        first = goal.feedback()[0].feedback
        self.assertAlmostEqual(first.position_error, 0.5, places=6)
        self.assertAlmostEqual(first.angle_error, math.atan2(-0.4, 0.3), places=6)

    def test_one_near_return_ahead_among_invalid_ranges_is_an_obstacle(self):
        for invalid in (0.0, math.nan, math.inf):
            for angle in (-29, -1, 0, 29):
                self.robot.see(invalid, range(360))
                self.robot.see(0.28, [angle])
                goal = self.run_goal(1.0, 0.0, "OBSTACLE")
                self.assertIn("obstacle 0.280 m ahead", goal.result().result.message)
                self.assertEqual(self.robot.commands.messages, [Twist()])

    def test_an_obstacle_ahead_does_not_stop_the_turn_away_from_it(self):
        self.robot.see(0.2, AHEAD)
        goal = self.robot.start(-0.5, 0.0)
        while abs(self.robot.pose.yaw) < 2.0:
            self.assertTrue(self.robot.tick(goal))
        self.robot.see(math.inf, AHEAD)
        self.robot.follow(goal)
        self.robot.end(goal, "REACHED")

    def test_obstacle_that_appears_while_driving_stops_the_robot_at_once(self):
        goal = self.robot.start(2.0, 0.0)
        for _ in range(20):
            self.assertTrue(self.robot.tick(goal))
        self.robot.see(0.25, [10])
        self.assertLess(self.robot.follow(goal), 0.35)
        self.robot.end(goal, "OBSTACLE")


if __name__ == "__main__":
    run(ServerDrives)
