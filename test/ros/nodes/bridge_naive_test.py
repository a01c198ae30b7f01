#!/usr/bin/env python3
"""ignore_goal_frame:=true is the lab's naive bridge, which is right only while the robot is at the origin of odom."""

from clicks import Clicks
from harness import SystemTest, distance, run, wait_for

from aro_robocop_goto_as.geometry import Pose2D, compose


class BridgeNaive(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def click_ahead(self):
        """Click half a metre ahead of the robot; the distance [m] of its last position from there."""
        target = compose(self.robot.pose(), Pose2D(0.5, 0.0))
        self.goals.clear()
        self.clicks.click(0.5, 0.0, "base_footprint")
        wait_for(self.goals.of_others, "a goal from the bridge")[0].result("REACHED")
        sent = self.goals.sent.messages[0].goal.position
        self.assertEqual((sent.x, sent.y), (0.5, 0.0))
        return distance(self.robot.wait_until_it_stands(), target)

    def test_coordinates_are_sent_unchanged_so_only_the_first_click_leads_where_it_points(self):
        self.assertLess(self.click_ahead(), 0.12)
        self.goals.log.wait_for(lambda m: "ignore_goal_frame is set" in m.msg, "a warning")
        self.assertGreater(self.click_ahead(), 0.35)  # the goal is odom (0.5, 0), where the robot already is


if __name__ == "__main__":
    run(BridgeNaive)
