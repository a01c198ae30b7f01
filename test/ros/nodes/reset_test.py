#!/usr/bin/env python3
"""A reset returns the robot to its spawn and odometry to zero, while time and goals continue."""

from harness import Recorder, SystemTest, call_simulator, distance, run
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.convert import from_pose_msg

SPAWN = Pose2D(-0.7, 0.2, 0.5)  # of the launch file
FAR = Pose2D(1.66, -1.13)  # in odom: 2 m of free way, so that a reset comes before its end


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

    def test_goal_continues_from_the_spawn_after_a_reset_during_the_goal(self):
        goal = self.goals.send(FAR.x, FAR.y)
        self.robot.wait_until_it_drives(0.15)
        call_simulator("reset")
        goal.result("REACHED")
        self.robot.wait_until_it_stands()
        self.assertLess(distance(self.robot.odom_pose(), FAR), 0.1)


if __name__ == "__main__":
    run(Reset)
