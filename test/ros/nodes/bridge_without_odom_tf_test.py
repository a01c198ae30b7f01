#!/usr/bin/env python3
"""Without an odom -> base_footprint transform on TF, the bridge uses the pose of the odometry messages.

The handout's own bridge, ignore_goal_frame:=true, is right only while the robot is at the origin of odom.
"""

from clicks import Clicks
from harness import Recorder, SystemTest, distance, run, wait_for
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, compose

NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry


class BridgeWithoutOdomTf(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks, cls.naive = Clicks(), Clicks("/naive")
        cls.tf = Recorder("/tf", TFMessage)

    def goal_of_the_bridge(self):
        """The bridge's first goal."""
        return wait_for(self.goals.of_others, "a goal from the bridge")[0]

    def test_goal_in_base_footprint_is_relative_to_the_robot(self):
        self.goals.send(0.2, -0.2).result("REACHED")
        start = self.robot.wait_until_it_stands()  # neither at the origin of odom nor along its x axis
        self.goals.clear()
        self.clicks.click(0.1, 0.4, "base_footprint")
        self.goal_of_the_bridge().result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), compose(start, Pose2D(0.1, 0.4))), NEAR)
        frames = {t.child_frame_id for m in self.tf.messages for t in m.transforms}
        self.assertNotIn("base_footprint", frames)
        self.assertIn("wheel_left_link", frames)

    def click_ahead_in_the_naive_bridge(self):
        """Click half a metre ahead of the robot; the distance [m] of its last position from there."""
        target = compose(self.robot.pose(), Pose2D(0.5, 0.0))
        self.goals.clear()
        self.naive.click(0.5, 0.0, "base_footprint")
        self.goal_of_the_bridge().result("REACHED")
        sent = self.goals.sent.messages[0].goal.position
        self.assertEqual((sent.x, sent.y), (0.5, 0.0))
        return distance(self.robot.wait_until_it_stands(), target)

    def test_naive_bridge_sends_numbers_unchanged_so_only_the_first_click_leads_where_it_points(self):
        self.assertLess(self.click_ahead_in_the_naive_bridge(), NEAR)
        self.goals.log.wait_for(lambda m: "ignore_goal_frame is set" in m.msg, "a warning")
        self.assertGreater(self.click_ahead_in_the_naive_bridge(), 0.35)  # odom (0.5, 0), where it already is


if __name__ == "__main__":
    run(BridgeWithoutOdomTf)
