#!/usr/bin/env python3
"""A goal ends once in each of actionlib's states, and the server serves the next one.

Outcomes that differ only in their reason are in test/unit/ros/server.
"""

import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from fake_robot import PERIOD, FakeRobot
from geometry_msgs.msg import Twist
from harness import run, wait_for


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


if __name__ == "__main__":
    run(ServerEnds)
