#!/usr/bin/env python3
"""A goal in any frame leads to the same place in the world, or is refused."""

import math

import rospy
from clicks import Clicks
from harness import SystemTest, distance, run, wait_for

from aro_robocop_goto_as.geometry import Pose2D

NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry


class BridgeFrames(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def setUp(self):
        super().setUp()
        self.clicks.status.clear()

    def sent(self):
        """Wait until the bridge has sent a goal; its position."""
        wait_for(lambda: self.goals.sent.messages, "a goal from the bridge")
        (message,) = self.goals.sent.messages
        return message.goal.position

    def test_goal_in_map_is_reached_there(self):
        self.clicks.click(-0.4, 0.2, "map")
        sent = self.sent()
        self.assertAlmostEqual(sent.x, 0.3, places=6)
        self.assertAlmostEqual(sent.y, 0.2, places=6)
        self.goals.of_others()[0].result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), Pose2D(-0.4, 0.2)), NEAR)

    def test_goal_in_base_footprint_is_relative_to_the_pose_at_the_stamp_of_the_click(self):
        self.goals.send(1.0, 0.0)
        self.robot.wait_until_it_drives(0.15)
        stamp = self.robot.odom.newest().header.stamp
        past = next(m for m in self.robot.odom.messages if m.twist.twist.linear.x > 0.05)
        wait_for(lambda: (rospy.Time.now() - stamp).to_sec() > 1.0, "one more second of driving")
        self.clicks.click(0.1, 0.0, "/base_footprint", past.header.stamp)
        wait_for(self.goals.of_others, "a goal from the bridge")
        sent = self.goals.sent.messages[-1].goal.position
        self.assertAlmostEqual(sent.x, past.pose.pose.position.x + 0.1, delta=0.001)
        self.goals.of_others()[0].result("REACHED")

    def test_goal_in_an_unknown_frame_or_of_nan_is_refused_with_the_reason_and_the_next_one_is_served(self):
        for click, words in (((0.5, 0.0, "kitchen"), "'kitchen' to 'odom'"), ((math.nan, 0.0, "map"), "finite")):
            self.clicks.status.clear()
            self.clicks.click(*click)
            self.assertIn(words, self.clicks.wait_for_status("goal refused"))
        self.assertEqual(self.goals.sent.messages, [])
        self.clicks.click(0.05, 0.0, "odom")
        self.sent()
        self.goals.of_others()[0].result("REACHED")


if __name__ == "__main__":
    run(BridgeFrames)
