#!/usr/bin/env python3
"""Goals that are cancelled, or replaced by a newer goal."""

import rospy
from actionlib_msgs.msg import GoalStatus
from harness import SystemTest, distance, run

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.convert import from_pose_msg


class Preempt(SystemTest):
    def driving_goal(self):
        """A goal 2 m ahead that the robot drives to."""
        goal = self.goals.send(2.0, 0.0)
        self.robot.wait_until_it_drives(0.15)
        return goal

    def test_cancel_stops_the_robot_and_the_goal_is_preempted(self):
        goal = self.driving_goal()
        goal.cancel()
        result = goal.result("PREEMPTED")
        self.assertIn("it was cancelled", result.result.message)
        self.assertEqual(result.status.status, GoalStatus.PREEMPTED)
        ended = self.robot.truth.wait_for(lambda m: m.header.stamp >= result.header.stamp, "the pose at its end")
        self.assertLess(distance(from_pose_msg(ended.pose.pose), self.robot.wait_until_it_stands()), 0.05)

    def test_newer_goal_preempts_the_older_and_is_reached(self):
        older = self.driving_goal()
        newer = self.goals.send(0.1, -0.1)
        self.assertIn("a newer goal replaced it", older.result("PREEMPTED").result.message)
        self.assertEqual(older.result().status.status, GoalStatus.PREEMPTED)
        newer.result("REACHED")
        self.robot.wait_until_it_stands()
        self.assertLess(distance(self.robot.odom_pose(), Pose2D(0.1, -0.1)), 0.1)
        older.assert_ended_once()

    def test_goals_replaced_before_they_begin_each_end_once_as_actionlib_ends_them(self):
        first = self.driving_goal()
        waiting = [self.goals.send(2.0, 0.1 * i) for i in range(20)]
        newest = self.goals.send(0.1, 0.1)
        newest.result("REACHED")
        for goal in [first, *waiting]:
            self.assertIn(goal.result().status.status, (GoalStatus.PREEMPTED, GoalStatus.RECALLED))
        recalled = [goal.result() for goal in waiting if goal.result().status.status == GoalStatus.RECALLED]
        self.assertEqual({result.result.message for result in recalled}, {""})

    def test_goal_stamped_before_the_current_one_is_recalled_and_the_current_one_goes_on(self):
        current = self.driving_goal()
        stamped_earlier = self.goals.send(0.1, 0.1, stamp=rospy.Time(0, 1))  # of a client whose clock is behind
        self.assertEqual(stamped_earlier.result().status.status, GoalStatus.RECALLED)
        current.result("REACHED")


if __name__ == "__main__":
    run(Preempt)
