#!/usr/bin/env python3
"""A goal in any frame leads to the same place in the world, or is refused."""

import math

import rospy
from clicks import Clicks
from harness import SystemTest, distance, run, wait_for

from aro_robocop_goto_as.geometry import Pose2D, compose

SPAWN = Pose2D(-0.7, 0.0)  # of the default world
LAST_STAMP = rospy.Time(2**32 - 1, 0)
NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry


class BridgeFrames(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def setUp(self):
        super().setUp()
        self.clicks.status.clear()

    def sent(self, count=1):
        """Wait until the bridge has sent `count` goals; their positions."""
        wait_for(lambda: len(self.goals.sent) >= count, f"{count} goals from the bridge")
        self.assertEqual(len(self.goals.sent), count)
        return [m.goal.position for m in self.goals.sent.messages]

    def assert_refused(self, *texts):
        """The click was refused with these texts and not sent, and the next click is served."""
        refusal = self.clicks.wait_for_status("goal refused")
        for text in texts:
            self.assertIn(text, refusal)
        self.assertEqual(self.goals.sent.messages, [])
        self.assertLess(distance(self.robot.pose(), SPAWN), 0.001)
        self.clicks.click(0.05, 0.0, "odom")
        self.sent()
        self.goals.of_others()[0].result("REACHED")

    def test_goal_in_map_is_reached_there(self):
        self.clicks.click(-0.4, 0.2, "map")
        sent = self.sent()[0]
        self.assertAlmostEqual(sent.x, 0.3, places=6)
        self.assertAlmostEqual(sent.y, 0.2, places=6)
        self.goals.of_others()[0].result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), Pose2D(-0.4, 0.2)), NEAR)

    def test_goal_in_base_footprint_is_relative_to_the_robot(self):
        self.goals.send(0.2, -0.2).result("REACHED")
        start = self.robot.wait_until_it_stands()  # neither at the origin of odom nor along its x axis
        self.goals.clear()
        self.clicks.click(0.0, 0.4, "base_footprint")
        self.sent()
        self.goals.of_others()[0].result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), compose(start, Pose2D(0.0, 0.4))), NEAR)

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

    def test_goal_without_a_frame_is_in_map_with_a_warning(self):
        self.clicks.click(-0.6, 0.0, "")
        self.assertAlmostEqual(self.sent()[0].x, 0.1, places=6)
        self.goals.log.wait_for(lambda m: "assuming the default 'map'" in m.msg, "a warning")
        self.goals.of_others()[0].result("REACHED")

    def test_goal_stamped_after_all_transforms_uses_the_latest_one_with_a_warning(self):
        self.clicks.click(0.1, 0.0, "base_footprint", LAST_STAMP)
        self.assertAlmostEqual(self.sent()[0].x, 0.1, delta=0.001)
        self.goals.log.wait_for(lambda m: "using the latest one" in m.msg, "a warning")
        self.goals.of_others()[0].result("REACHED")

    def test_goal_in_an_unknown_frame_is_refused_with_the_names_of_both_frames(self):
        self.clicks.click(0.5, 0.0, "kitchen")
        self.assert_refused("'kitchen'", "'odom'")

    def test_goal_of_nan_is_refused(self):
        self.clicks.click(math.nan, 0.0, "map")
        self.assert_refused("nan", "finite")


if __name__ == "__main__":
    run(BridgeFrames)
