"""2D Nav Goals on their way through the bridge: transformed, replaced by newer ones, or refused with the reason.

Which transform a goal gets, and what the status says, are in test/unit/ros/client.
"""

from actionlib_msgs.msg import GoalStatus
from clicks import Clicks
from harness import SystemTest, distance, wait_for

from aro_robocop_goto_as.geometry import Pose2D

TARGET = Pose2D(-0.4, 0.2)  # in map [m]
NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry


class Bridge(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clicks = Clicks()

    def setUp(self):
        super().setUp()
        self.clicks.status.clear()

    def test_goal_in_map_is_reached_there_after_one_in_an_unknown_frame_was_refused(self):
        self.clicks.click(0.5, 0.0, "kitchen")
        self.assertIn("'kitchen' to 'odom'", self.clicks.wait_for_status("goal refused"))
        self.clicks.click(TARGET.x, TARGET.y, "map")
        wait_for(self.goals.of_others, "a goal from the bridge")[0].result("REACHED")
        (sent,) = self.goals.sent.messages
        self.assertAlmostEqual(sent.goal.position.x, 0.3, places=6)
        self.assertLess(distance(self.robot.wait_until_it_stands(), TARGET), NEAR)

    def test_of_several_quick_clicks_only_the_newest_is_reached_and_each_goal_ends_once(self):
        for i in range(8):
            self.clicks.click(1.5, 0.1 * i, "map")
        self.clicks.click(TARGET.x, TARGET.y, "map")
        reached = self.goals.results.wait_for(lambda m: m.result.success, "a goal that is reached")
        self.assertEqual(reached.status.goal_id.id, self.goals.of_others()[-1].id)
        self.assertLess(distance(self.robot.wait_until_it_stands(), TARGET), NEAR)
        for goal in self.goals.of_others()[:-1]:
            self.assertIn(goal.result().status.status, (GoalStatus.PREEMPTED, GoalStatus.RECALLED))
