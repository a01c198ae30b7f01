#!/usr/bin/env python3
"""A new click replaces the goal of the one before: the bridge cancels it, and every goal ends once."""

from actionlib_msgs.msg import GoalStatus
from clicks import Clicks
from harness import SystemTest, distance, run, wait_for

from aro_robocop_goto_as.geometry import Pose2D

NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry


class BridgeClicks(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def setUp(self):
        super().setUp()
        self.clicks.status.clear()

    def test_of_several_quick_clicks_only_the_newest_is_reached_and_each_goal_ends_once(self):
        for i in range(8):
            self.clicks.click(1.5, 0.1 * i, "map")
        self.clicks.click(-0.4, 0.2, "map")
        reached = self.goals.results.wait_for(lambda m: m.result.success, "a goal that is reached")
        self.assertEqual(reached.status.goal_id.id, self.goals.of_others()[-1].id)
        self.assertLess(distance(self.robot.wait_until_it_stands(), Pose2D(-0.4, 0.2)), NEAR)
        for goal in self.goals.of_others()[:-1]:
            self.assertIn(goal.result().status.status, (GoalStatus.PREEMPTED, GoalStatus.RECALLED))

    def test_status_follows_a_goal_from_its_start_to_its_end(self):
        self.clicks.click(1.0, 0.0, "map")
        self.clicks.wait_for_status("goal x 1.00 y 0.00 in map is ")
        driving = self.clicks.wait_for_status("is ACTIVE: driving, ")
        self.assertRegex(driving, r"\(position_error \d\.\d\d m, angle_error -?\d\.\d\d rad\)$")
        wait_for(self.goals.of_others, "a goal from the bridge")[0].cancel()
        self.clicks.wait_for_status("robocop_goto_as is ready, last goal PREEMPTED: goal ")


if __name__ == "__main__":
    run(BridgeClicks)
