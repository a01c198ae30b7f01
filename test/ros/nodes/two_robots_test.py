"""Two robots: a goal for one moves only that one, and their frames are told apart by a prefix."""

import unittest

import tf2_ros
import yaml
from clicks import Clicks
from harness import ACTION, SERVER, Goals, Robot, distance, script, wait_for
from systems import Process

from aro_robocop_goto_as.geometry import Pose2D, compose

NEAR = 0.12  # [m] the handout's tolerance of 0.1 m, and the drift of odometry
STILL = 0.005  # [m]
LINKS = {  # child: parent, of a Burger
    "base_footprint": "odom",
    "base_link": "base_footprint",
    "base_scan": "base_link",
    "imu_link": "base_link",
    "caster_back_link": "base_link",
    "wheel_left_link": "base_link",
    "wheel_right_link": "base_link",
}


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

    def test_goal_in_the_frame_of_the_other_robot_is_relative_to_that_one_which_does_not_move(self):
        stood = self.robots[1].pose()
        target = compose(stood, Pose2D(-0.1, 0.5))
        self.clicks[0].click(-0.1, 0.5, "robot_2/base_footprint")
        wait_for(self.goals[0].of_others, "a goal from the bridge of robot_1")[0].result("REACHED")
        self.assertLess(distance(self.robots[0].wait_until_it_stands(), target), NEAR)
        self.assertLess(max(distance(pose, stood) for pose in self.robots[1].path()), STILL)
        self.assertEqual(self.goals[1].sent.messages + self.robots[1].commands.messages, [])

    def test_tf_is_one_tree_in_which_each_frame_of_a_robot_has_its_prefix(self):
        buffer = tf2_ros.Buffer(debug=False)
        self.addCleanup(tf2_ros.TransformListener(buffer).unregister)

        def tree():
            frames = yaml.safe_load(buffer.all_frames_as_yaml()) or {}
            return {frame: link["parent"] for frame, link in frames.items()}

        expected = {"map": "world"}
        for name in ("robot_1", "robot_2"):
            expected[f"{name}/odom"] = "map"
            expected.update({f"{name}/{child}": f"{name}/{parent}" for child, parent in LINKS.items()})
        wait_for(lambda: len(tree()) >= len(expected), lambda: f"{len(expected)} frames; there are {tree()}")
        self.assertEqual(tree(), expected)

    def test_goto_command_moves_the_named_robot(self):
        with Process(script("robocop_goto.py"), "-1.6", "-0.4", "--frame", "map", "--robot", "robot_2") as command:
            self.assertEqual(command.wait_for_exit(), 0, command.output)
        self.assertLess(distance(self.robots[1].wait_until_it_stands(), Pose2D(-1.6, -0.4)), NEAR)
