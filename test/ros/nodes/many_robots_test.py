#!/usr/bin/env python3
"""Ten robots in one world, each with its own frames, scan and server, and a goal for each at the same time.

Time stands while goals are sent, and advances by ~step.
"""

import unittest

import rospy
import tf2_ros
import yaml
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import SimStatus
from aro_robocop_goto_as.srv import Step
from harness import (
    ACTION,
    DEADLINE,
    SERVER,
    SIMULATOR,
    Goals,
    Recorder,
    call_simulator,
    distance,
    run,
    wait_for,
)
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.ros.convert import from_pose_msg

NAMES = [f"robot_{i}" for i in range(1, 11)]
START = 120.0  # [s, wall] for ten servers to come up
# The goal of each robot in its base_footprint [m], and its outcome in the default world.
GOALS = {
    "robot_1": (-0.8, 0.0, "OBSTACLE"),  # robot_2
    "robot_2": (0.05, 0.05, "REACHED"),  # without moving
    "robot_3": (0.5, 0.0, "REACHED"),  # where robot_7 stood before it left
    "robot_4": (0.0, 0.6, "OBSTACLE"),  # a wall
    "robot_5": (0.6, 0.0, "REACHED"),
    "robot_6": (-0.5, 0.0, "REACHED"),
    "robot_7": (0.6, -0.1, "REACHED"),
    "robot_8": (0.9, 0.0, "OBSTACLE"),  # a pillar
    "robot_9": (0.0, -0.5, "REACHED"),
    "robot_10": (0.0, -0.6, "REACHED"),
}
TOLERANCE = 0.1  # [m] of the handout
BASE_FROM_SCAN = Pose2D(-0.032, 0.0)
SCAN_HEIGHT = 0.182  # [m] of a Burger
LINKS = {  # child: parent, of a Burger
    "base_footprint": "odom",
    "base_link": "base_footprint",
    "base_scan": "base_link",
    "imu_link": "base_link",
    "caster_back_link": "base_link",
    "wheel_left_link": "base_link",
    "wheel_right_link": "base_link",
}


class ManyRobots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        status = Recorder(f"{SIMULATOR}/status", SimStatus)
        expected = sorted(f"/{name}{SERVER} driving {name}" for name in NAMES)
        wait_for(
            lambda: status.messages and status.messages[-1].drivers == expected,
            lambda: f"lockstep waits for all servers; the last status: {status.messages[-1:]}",
            START,
        )
        cls.step_service = rospy.ServiceProxy(f"{SIMULATOR}/step", Step)
        cls.step_service.wait_for_service(DEADLINE)
        cls.goals = [Goals(f"/{name}/{ACTION}", f"/{name}{SERVER}") for name in NAMES]
        cls.truth = [Recorder(f"/{name}/ground_truth_odom", Odometry) for name in NAMES]

    def setUp(self):
        call_simulator("reset")
        for truth in self.truth:
            truth.clear()
        self.step_until(lambda: all(self.truth), "ground truth of every robot")

    def step(self, seconds):
        """Advance time, and wait until this node has received it; the new time."""
        answer = self.step_service(seconds)
        self.assertTrue(answer.success, answer.message)
        wait_for(lambda: rospy.get_rostime() >= answer.stamp, "the clock")
        return answer.stamp

    def step_until(self, condition, what, seconds=0.1):
        """Advance time in steps until a condition is true."""
        wait_for(lambda: self.step(seconds) and condition(), what, START)

    def poses_now(self):
        """The true poses of all robots now."""
        stamp = self.step(0.1)
        current = [truth.wait_for(lambda m: m.header.stamp == stamp, "current ground truth") for truth in self.truth]
        return [from_pose_msg(message.pose.pose) for message in current]

    def test_tf_has_every_frame_of_every_robot_below_map_and_no_frame_without_prefix(self):
        buffer = tf2_ros.Buffer(debug=False)
        listener = tf2_ros.TransformListener(buffer)
        self.addCleanup(listener.unregister)
        expected = {"map": "world"}
        for name in NAMES:
            expected[f"{name}/odom"] = "map"
            expected.update({f"{name}/{child}": f"{name}/{parent}" for child, parent in LINKS.items()})

        def tree():
            frames = yaml.safe_load(buffer.all_frames_as_yaml()) or {}
            return {frame: link["parent"] for frame, link in frames.items()}

        self.step_until(lambda: len(tree()) >= len(expected), lambda: f"{len(expected)} frames; there are {tree()}")
        self.assertEqual(tree(), expected)
        for name, pose in zip(NAMES, self.poses_now()):
            there, scanner = compose(pose, BASE_FROM_SCAN), f"{name}/base_scan"
            translation = buffer.lookup_transform("map", scanner, rospy.Time(0)).transform.translation
            self.assertLess(distance(translation, there), 1e-3, scanner)
            self.assertAlmostEqual(translation.z, SCAN_HEIGHT, delta=1e-6)

    def test_ten_goals_at_once_end_as_ground_truth_shows(self):
        starts = self.poses_now()
        sent = [goals.send(*GOALS[name][:2]) for name, goals in zip(NAMES, self.goals)]
        for goal in sent:
            wait_for(lambda goal=goal: GoalStatus.ACTIVE in goal.states(), "acceptance of a goal")
        self.step_until(lambda: all(goal.results() for goal in sent), "the end of every goal", 1.0)
        ends = self.poses_now()
        for i, (name, goal) in enumerate(zip(NAMES, sent)):
            x, y, word = GOALS[name]
            with self.subTest(robot=name, result=goal.result().result.message):
                goal.assert_ended_once()
                goal.result(word)
                if word == "REACHED":
                    self.assertLess(distance(ends[i], compose(starts[i], Pose2D(x, y))), TOLERANCE + 0.01)
        for goals in self.goals:
            goals.assert_each_ended_once()
            self.assertEqual(goals.of_others(), [])


if __name__ == "__main__":
    run(ManyRobots)
