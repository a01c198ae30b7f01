#!/usr/bin/env python3
"""A goal is reached as in the handout: turn towards it, drive to it, stop."""

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal
from geometry_msgs.msg import Point
from harness import ACTION, SystemTest, distance, in_world, run

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle

SPAWN = Pose2D(-0.7, 0.0)  # of the default world
TOLERANCE = 0.1  # [m] of the handout
DRIFT = 0.02  # [m] of odometry over these short distances


def turned(path):
    """The turns along a path [rad], to the left and to the right added up."""
    return sum(abs(wrap_angle(b.yaw - a.yaw)) for a, b in zip(path, path[1:]))


class ReachGoal(SystemTest):
    def test_handouts_action_client_gets_success_and_the_robot_stands_at_the_goal(self):
        client = actionlib.SimpleActionClient(ACTION, GoToPositionAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(300.0)))
        client.send_goal(GoToPositionGoal(Point(0.4, 0.3, 0.0)))
        self.assertTrue(client.wait_for_result(rospy.Duration(300.0)))
        self.assertEqual(client.get_state(), GoalStatus.SUCCEEDED)
        self.assertTrue(client.get_result().success)
        self.assertRegex(
            client.get_result().message, r"^REACHED: 0\.(0..|100) m from the goal x 0\.40 y 0\.30 in odom after "
        )
        self.assertLess(
            distance(self.robot.wait_until_it_stands(), in_world(SPAWN, Pose2D(0.4, 0.3))), TOLERANCE + DRIFT
        )

    def test_goal_at_the_robots_position_is_reached_at_once_without_moving(self):
        self.goals.send(0.05, 0.05).result("REACHED")
        self.robot.wait_until_it_stands()
        self.assertEqual({(m.linear.x, m.angular.z) for m in self.robot.commands.messages}, {(0.0, 0.0)})
        self.assertLess(turned(self.robot.path()), 0.01)


if __name__ == "__main__":
    run(ReachGoal)
