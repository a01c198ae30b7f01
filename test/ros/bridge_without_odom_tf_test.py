#!/usr/bin/env python3
"""Where TF doesn't know the robot, the bridge takes its pose from the odometry."""

from clicks import Clicks
from harness import Recorder, SystemTest, distance, run, wait_for
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, compose

NEAR = 0.12  # [m] the handout's tolerance with a little drift of odometry


class BridgeWithoutOdomTf(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()
        cls.tf = Recorder("/tf", TFMessage)

    def goal_of_the_bridge(self):
        """Its first goal."""
        return wait_for(self.goals.of_others, "a goal from the bridge")[0]

    def test_goal_in_base_footprint_is_reached_as_seen_from_the_robot(self):
        self.goals.send(0.2, -0.2).result("REACHED")
        start = self.robot.wait_until_it_stands()  # neither at odom's origin nor along its x axis
        self.goals.forget()
        self.clicks.click(0.1, 0.4, "base_footprint")
        self.goal_of_the_bridge().result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), compose(start, Pose2D(0.1, 0.4))), NEAR)
        frames = {t.child_frame_id for m in self.tf.messages for t in m.transforms}
        self.assertNotIn("base_footprint", frames)
        self.assertIn("wheel_left_link", frames)

    def test_goal_in_map_is_reached(self):
        self.clicks.click(-0.5, -0.2, "map")
        self.goal_of_the_bridge().result("REACHED")
        self.assertLess(distance(self.robot.wait_until_it_stands(), Pose2D(-0.5, -0.2)), NEAR)

    def test_goal_in_a_frame_of_neither_tf_nor_odometry_is_refused(self):
        self.clicks.status.forget()
        self.clicks.click(0.3, 0.0, "base_scan")  # TF knows it as part of the robot, but not where the robot is
        self.assertIn("'base_scan' to 'odom'", self.clicks.wait_for_status("goal refused"))
        self.assertEqual(self.goals.sent.messages, [])


if __name__ == "__main__":
    run(BridgeWithoutOdomTf)
