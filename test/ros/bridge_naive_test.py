#!/usr/bin/env python3
"""ignore_goal_frame:=true is the lab's naive bridge: right only while the robot still is at odom's origin."""

from clicks import Clicks
from harness import SystemTest, distance, run, wait_for

from aro_robocop_goto_as.geometry import Pose2D, compose


class BridgeNaive(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def click_ahead(self):
        """A click half a metre ahead of the robot; how far from that place the robot ends up [m]."""
        meant = compose(self.robot.pose(), Pose2D(0.5, 0.0))
        self.goals.forget()
        self.clicks.click(0.5, 0.0, "base_footprint")
        wait_for(self.goals.of_others, "a goal from the bridge")[0].result("REACHED")
        sent = self.goals.sent.messages[0].goal.position
        self.assertEqual((sent.x, sent.y), (0.5, 0.0))
        return distance(self.robot.wait_until_it_stands(), meant)

    def test_numbers_of_a_click_go_to_the_server_as_they_are_so_only_the_first_one_leads_where_it_points(self):
        self.assertLess(self.click_ahead(), 0.12)
        self.goals.log.wait_for(lambda m: "ignore_goal_frame is set" in m.msg, "a warning")
        self.assertGreater(self.click_ahead(), 0.35)  # "go to odom (0.5, 0)", where it is already


if __name__ == "__main__":
    run(BridgeNaive)
