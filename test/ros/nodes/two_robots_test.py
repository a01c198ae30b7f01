#!/usr/bin/env python3
"""A 2D Nav Goal on one robot's topic moves only that robot, even if it is in another robot's frame."""

import unittest

from clicks import Clicks
from harness import ACTION, SERVER, SIMULATOR, Goals, Recorder, Robot, distance, run, script, wait_for
from systems import Process
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.geometry import Pose2D, compose

NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry
STILL = 0.005  # [m]


class TwoRobots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        names = ("/robot_1", "/robot_2")
        cls.robots = [Robot(name) for name in names]
        cls.goals = [Goals(f"{name}/{ACTION}", name + SERVER) for name in names]
        cls.clicks = [Clicks(name) for name in names]

    def setUp(self):
        for robot, goals, clicks in zip(self.robots, self.goals, self.clicks):
            robot.reset()
            goals.clear()
            clicks.status.clear()

    def tearDown(self):
        for goals in self.goals:
            goals.assert_each_ended_once()

    def assert_only_it_arrives(self, robot, target):
        """After a click for a robot, it reaches the target, and the other one neither gets a goal nor moves."""
        other = 1 - robot
        stood = self.robots[other].pose()
        goal = wait_for(self.goals[robot].of_others, f"a goal from the bridge of robot {robot}")[0]
        goal.result("REACHED")
        self.assertLess(distance(self.robots[robot].wait_until_it_stands(), target), NEAR)
        self.assertLess(max(distance(pose, stood) for pose in self.robots[other].path()), STILL)
        self.assertEqual(self.goals[other].sent.messages, [])
        self.assertEqual(self.robots[other].commands.messages, [])

    def test_each_robot_serves_its_own_goal_at_the_same_time(self):
        targets = [Pose2D(-0.2, -0.4), Pose2D(-1.6, 0.4)]
        for clicks, target in zip(self.clicks, targets):
            clicks.click(target.x, target.y, "map")
        for robot, goals, target in zip(self.robots, self.goals, targets):
            wait_for(goals.of_others, "a goal from the bridge")[0].result("REACHED")
            self.assertLess(distance(robot.wait_until_it_stands(), target), NEAR)

    def test_goal_in_the_frame_of_the_other_robot_is_relative_to_that_one(self):
        target = compose(self.robots[1].pose(), Pose2D(-0.1, 0.5))
        self.clicks[0].click(-0.1, 0.5, "robot_2/base_footprint")
        self.assert_only_it_arrives(0, target)

    def test_goto_command_moves_the_named_robot(self):
        with Process(script("robocop_goto.py"), "-1.6", "-0.4", "--frame", "map", "--robot", "robot_2") as command:
            self.assertEqual(command.wait_for_exit(), 0, command.output)
        self.assertLess(distance(self.robots[1].wait_until_it_stands(), Pose2D(-1.6, -0.4)), NEAR)

    def test_goto_command_without_a_name_lists_the_robots(self):
        with Process(script("robocop_goto.py"), "0.5", "0") as command:
            self.assertEqual(command.wait_for_exit(), 1)
        both = "'/robot_1/robocop_goto_as' and '/robot_2/robocop_goto_as'"
        self.assertIn(f"{both} of the same type: which robot is meant?", command.output)

    def test_each_robot_has_a_name_marker_in_its_frame(self):
        shapes = Recorder(f"{SIMULATOR}/world", MarkerArray).newest().markers
        self.assertEqual(
            {m.text: m.header.frame_id for m in shapes if m.ns == "names"},
            {name: f"{name}/base_footprint" for name in ("robot_1", "robot_2")},
        )


if __name__ == "__main__":
    run(TwoRobots)
