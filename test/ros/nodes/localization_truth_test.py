#!/usr/bin/env python3
"""localization:=truth corrects map -> odom for the error of odometry, here of wheels that slip at a wall."""

import math
import unittest

from commands import Commands
from harness import Recorder, Robot, distance, run, wait_for
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.ros.convert import from_pose_msg

SPAWN = Pose2D(1.0, 0.0)  # of the launch file
WALL = 2.35  # [m] x of its face
FRONT = 0.07 - 0.032  # [m] from base_footprint to the front of the collision box


def pose_of(transform):
    """A TF transform on the plane."""
    t = transform.transform
    return Pose2D(t.translation.x, t.translation.y, 2.0 * math.atan2(t.rotation.z, t.rotation.w))


class LocalizationTruth(unittest.TestCase):
    def test_pose_on_tf_stays_true_while_the_robot_hits_a_wall_and_backs_out(self):
        robot, commands, tf = Robot(), Commands(), Recorder("/tf", TFMessage)
        robot.reset()
        self.assertLess(distance(robot.odom_pose(), Pose2D()), 0.001)  # wherever it is spawned
        self.assertLess(distance(robot.pose(), SPAWN), 0.001)

        with commands.repeated(0.2):
            start = len(robot.odom)
            robot.odom.wait_for(lambda m: m.pose.pose.position.x > 2.0, "odometry past the wall", start)
        at_the_wall = robot.wait_for_standstill()
        self.assertAlmostEqual(at_the_wall.x, WALL - FRONT, delta=0.01)
        self.assertGreater(robot.odom_pose().x - (at_the_wall.x - SPAWN.x), 0.5)

        with commands.repeated(-0.2):
            wait_for(lambda: robot.pose().x < WALL - 0.5, "the robot away from the wall")
        robot.wait_for_standstill()

        truth = {m.header.stamp: from_pose_msg(m.pose.pose) for m in robot.truth.messages}
        compared = 0
        for message in tf.messages:
            found = {t.child_frame_id: t for t in message.transforms}
            if "odom" in found and found["odom"].header.stamp in truth:
                self.assertEqual(found["odom"].header.frame_id, "map")
                self.assertEqual(found["odom"].header.stamp, found["base_footprint"].header.stamp)
                map_from_base = compose(pose_of(found["odom"]), pose_of(found["base_footprint"]))
                there = truth[found["odom"].header.stamp]
                self.assertLess(distance(map_from_base, there), 1e-6)
                self.assertAlmostEqual(map_from_base.yaw, there.yaw, delta=1e-6)
                compared += 1
        self.assertGreater(compared, 100)


if __name__ == "__main__":
    run(LocalizationTruth)
