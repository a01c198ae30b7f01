#!/usr/bin/env python3
"""A reset returns the robot to its spawn and odometry to zero, while time and goals continue."""

from harness import Recorder, SystemTest, call_simulator, distance, run
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.convert import from_pose_msg

SPAWN = Pose2D(-0.7, 0.2, 0.5)  # of the launch file


class Reset(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clock = Recorder("/clock", Clock)

    def test_reset_returns_the_robot_to_its_spawn_and_odometry_to_zero_while_time_continues(self):
        self.goals.send(0.3, 0.2).result("REACHED")
        self.robot.wait_until_it_stands()
        self.assertGreater(distance(self.robot.pose(), SPAWN), 0.2)
        self.clock.clear()
        before = self.clock.next(1)[0].clock
        call_simulator("reset")
        start = len(self.robot.truth)
        self.robot.truth.wait_for(lambda m: distance(from_pose_msg(m.pose.pose), SPAWN) < 0.001, "the spawn", start)
        self.assertLess(distance(self.robot.odom_pose(), Pose2D()), 0.001)
        self.assertAlmostEqual(self.robot.odom_pose().yaw, 0.0, delta=0.001)
        stamps = [m.clock for m in self.clock.messages]
        self.assertGreater(stamps[-1], before)
        self.assertEqual(stamps, sorted(stamps))


if __name__ == "__main__":
    run(Reset)
