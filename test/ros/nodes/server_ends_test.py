#!/usr/bin/env python3
"""Every outcome of a goal, and that the server serves the next goal after each of them."""

import math
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from fake_robot import PERIOD, FakeRobot
from geometry_msgs.msg import Twist
from harness import run, wait_for

from aro_robocop_goto_as.geometry import Pose2D


class ServerEnds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = FakeRobot()

    def setUp(self):
        self.robot.renew()

    def start(self, x=2.0, y=0.0, ticks=10):
        """Send a goal and follow it for some control periods; the goal."""
        goal = self.robot.start(x, y)
        for _ in range(ticks):
            self.assertTrue(self.robot.tick(goal))
        return goal

    def assert_ended(self, goal, word):
        """A goal has this outcome, the last command is zero, and the next goal is reached; the result's message."""
        result = self.robot.end(goal, word)
        self.robot.goals.assert_each_ended_once()
        self.robot.renew()
        following = self.start(0.3, 0.0, ticks=0)
        self.robot.follow(following)
        self.robot.end(following, "REACHED")
        self.robot.goals.assert_each_ended_once()
        return result.result.message

    def test_goal_is_reached(self):
        goal = self.start(0.5, 0.0)
        self.robot.follow(goal)
        text = self.assert_ended(goal, "REACHED")
        self.assertRegex(text, r"^REACHED: 0\.(0..|100) m from the goal x 0\.50 y 0\.00 in odom after \d\.\d s$")

    def test_obstacle_ahead_ends_the_goal(self):
        goal = self.start()
        self.robot.see(0.2, [0])
        self.robot.follow(goal)
        self.assertRegex(self.assert_ended(goal, "OBSTACLE"), r"^OBSTACLE: obstacle 0\.200 m ahead \(limit 0\.3 m\); ")

    def test_cancel_is_served_within_the_control_period_while_the_clock_is_stopped(self):
        goal = self.start()
        goal.cancel()
        self.assertEqual(self.robot.end(goal, "PREEMPTED").header.stamp, self.robot.now)
        self.assertEqual(len(self.robot.commands), 11)  # one for each control period, and then zero
        self.assert_ended(goal, "PREEMPTED")

    def test_replaced_goals_each_end_once_and_those_that_never_began_as_actionlib_ends_them(self):
        first = self.start()
        waiting = [self.robot.goals.send(2.0, 0.1 * number) for number in range(20)]
        newest = self.robot.goals.send(self.robot.pose.x, self.robot.pose.y)
        wait_for(lambda: self.robot.pass_time(PERIOD) or newest.results(), "the end of the newest goal")
        self.assertIn("a newer goal replaced it", first.result("PREEMPTED").result.message)
        ended = [goal.result() for goal in waiting]
        self.assertLessEqual({m.status.status for m in ended}, {GoalStatus.PREEMPTED, GoalStatus.RECALLED})
        recalled = [m.result.message for m in ended if m.status.status == GoalStatus.RECALLED]
        self.assertEqual(set(recalled), {""})
        self.assert_ended(newest, "REACHED")

    def test_goal_stamped_before_the_current_one_is_recalled_and_the_current_one_goes_on(self):
        current = self.start()
        stamped_earlier = self.robot.goals.send(0.1, 0.1, stamp=rospy.Time(0, 1))  # of a client whose clock is behind
        self.assertEqual(stamped_earlier.result().status.status, GoalStatus.RECALLED)
        self.robot.follow(current)
        self.assert_ended(current, "REACHED")

    def test_goal_ends_after_one_second_without_a_scan_or_odometry_but_not_sooner(self):
        for topic, word in (("scan", "NO_SCAN"), ("odom", "NO_ODOM")):
            goal, silent = self.start(), {topic: False}
            for _ in range(8):
                self.assertTrue(self.robot.tick(goal, **silent))
            for _ in range(3):
                self.assertTrue(self.robot.tick(goal))
            self.robot.settle()  # or late messages would extend the time with data
            took = self.robot.follow(goal, **silent)
            self.assertTrue(0.85 < took < 1.25, took)  # a message before a clock tick is stamped with the tick before
            expected = rf"^{word}: no message on /{topic} for 1\.\d s \(limit 1 s\)$"
            self.assertRegex(self.assert_ended(goal, word), expected)

    def test_scan_of_nan_ahead_for_a_second_ends_the_goal_but_not_for_less(self):
        goal = self.start()
        self.robot.see(math.nan, range(-40, 41))
        for _ in range(8):
            self.assertTrue(self.robot.tick(goal))
        self.robot.see(math.inf, [0])
        for _ in range(3):
            self.assertTrue(self.robot.tick(goal))
        self.robot.see(math.nan, [0])
        took = self.robot.follow(goal)
        self.assertTrue(0.85 < took < 1.25, took)
        text = self.assert_ended(goal, "NO_SCAN")
        self.assertRegex(text, r"^NO_SCAN: no valid beam ahead on /scan for 1\.\d s \(limit 1 s\)$")

    def test_stale_data_does_not_move_the_robot_and_ends_the_goal_a_second_after_its_start(self):
        self.robot.pass_time(60.0, odom=False, scan=False)
        goal, start = self.start(ticks=0), self.robot.now
        wait_for(lambda: self.robot.pass_time(PERIOD, odom=False, scan=False) or goal.results(), "the goal's end")
        self.assertGreater((self.robot.end(goal, "NO_ODOM").header.stamp - start).to_sec(), 0.85)
        self.assertEqual(self.robot.commands.messages, [Twist()])
        self.assert_ended(goal, "NO_ODOM")

    def test_goal_ends_as_stuck_after_five_seconds_without_progress_and_other_nodes_that_command_are_named(self):
        commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.addCleanup(commands.unregister)
        goal = self.start()
        self.robot.obeys = False
        took = self.robot.follow(goal)
        self.assertTrue(4.5 < took < 5.5, took)
        text = self.assert_ended(goal, "STUCK")
        self.assertRegex(text, r"^STUCK: no progress for 5\.\d s; 1\.\d+ m")
        self.assertTrue(text.endswith(f"; /cmd_vel is also published by {rospy.get_name()}"), text)

    def test_goal_ends_at_its_timeout(self):
        goal = self.start(100.0, 0.0)
        self.assertAlmostEqual(self.robot.follow(goal) + 1.0, 15.1, delta=0.25)
        text = self.assert_ended(goal, "TIMEOUT")
        self.assertRegex(
            text,
            r"^TIMEOUT: not reached within 15 s; 9\d\.\d+ m from the goal x 100\.00 y 0\.00 in odom after 15\.\d s$",
        )

    def test_goal_of_nan_infinity_or_out_of_reach_is_a_bad_goal_and_does_not_move_the_robot(self):
        for x, y in ((math.nan, 0.0), (0.0, math.inf), (-1e39, 0.0)):
            goal = self.robot.send(x, y)
            self.assertIn(f"position x {x} y {y}", self.robot.end(goal, "BAD_GOAL").result.message)
            self.assertEqual(self.robot.commands.messages, [Twist()])
            self.assert_ended(goal, "BAD_GOAL")

    def test_odometry_of_nan_or_huge_numbers_ends_the_goal_and_not_the_server(self):
        for x, y in ((math.nan, 0.0), (0.0, -1e39)):
            goal = self.start()
            self.robot.stand_at(Pose2D(x, y))
            self.robot.follow(goal)
            expected = f"/odom holds an impossible pose: expected finite numbers within +-1e+06 m, got x {x} y {y}"
            self.assertEqual(self.assert_ended(goal, "ERROR"), f"ERROR: {expected}")


if __name__ == "__main__":
    run(ServerEnds)
