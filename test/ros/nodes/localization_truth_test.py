#!/usr/bin/env python3
"""localization:=truth publishes map -> odom so that the pose on TF is the true one."""

import math
import unittest

from commands import Commands
from harness import Recorder, Robot, distance, run
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.ros.convert import from_pose_msg


def pose_of(transform):
    """A TF transform on the plane."""
    t = transform.transform
    return Pose2D(t.translation.x, t.translation.y, 2.0 * math.atan2(t.rotation.z, t.rotation.w))


class LocalizationTruth(unittest.TestCase):
    def test_pose_on_tf_is_the_true_one_after_a_turn(self):
        robot, tf = Robot(), Recorder("/tf", TFMessage)
        robot.reset()
        Commands().once(0.2, 1.0)
        turned = robot.truth.wait_for(lambda m: from_pose_msg(m.pose.pose).yaw > 0.3, "a robot that has turned")
        stamp = turned.header.stamp
        sent = tf.wait_for(
            lambda m: {(t.child_frame_id, t.header.stamp) for t in m.transforms} >= {("odom", stamp)}, "map -> odom"
        )
        found = {t.child_frame_id: t for t in sent.transforms}
        self.assertEqual(found["odom"].header.frame_id, "map")
        map_from_base = compose(pose_of(found["odom"]), pose_of(found["base_footprint"]))
        there = from_pose_msg(turned.pose.pose)
        self.assertLess(distance(map_from_base, there), 1e-6)
        self.assertAlmostEqual(map_from_base.yaw, there.yaw, delta=1e-6)


if __name__ == "__main__":
    run(LocalizationTruth)
