#!/usr/bin/env python3
"""While the simulator is paused, time and robot stand still, and goals and cancels are still served."""

import rospy
from harness import Recorder, SystemTest, call_simulator, distance, run, wait_for
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.geometry import Pose2D


class Pause(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clock = Recorder("/clock", Clock)

    def tearDown(self):
        call_simulator("unpause")
        super().tearDown()

    def pause_while_driving(self):
        """Pause while the robot drives to a goal; the goal, and the time of the pause."""
        goal = self.goals.send(0.6, 0.0)
        self.robot.wait_until_it_drives(0.1)
        answer = call_simulator("pause")
        self.assertRegex(answer, r"^paused at \d+\.\d+ s$")
        paused_at = self.clock.next(3)[-1].clock
        self.assertAlmostEqual(paused_at.to_sec(), float(answer.split()[2]), delta=0.001)
        wait_for(lambda: rospy.get_rostime() == paused_at, "the clock at the pause")
        return goal, paused_at

    def test_time_stops_while_paused_and_continues_from_there(self):
        _, paused_at = self.pause_while_driving()
        self.assertEqual({m.clock for m in self.clock.next(5)}, {paused_at})  # repeated for nodes that start meanwhile
        self.robot.odom.clear()
        call_simulator("unpause")
        self.assertLess((self.robot.odom.next()[0].header.stamp - paused_at).to_sec(), 0.5)

    def test_cancel_is_served_while_paused_and_the_robot_stays_stopped(self):
        goal, paused_at = self.pause_while_driving()
        goal.cancel()
        self.assertEqual(goal.result("PREEMPTED").header.stamp, paused_at)
        here = self.robot.path()[-1]
        call_simulator("unpause")
        self.assertLess(distance(here, self.robot.wait_until_it_stands()), 0.1)

    def test_goal_continues_after_a_pause(self):
        goal, paused_at = self.pause_while_driving()
        call_simulator("unpause")
        result = goal.result("REACHED")
        self.assertGreater(result.header.stamp, paused_at)
        self.robot.wait_until_it_stands()
        self.assertLess(distance(self.robot.odom_pose(), Pose2D(0.6, 0.0)), 0.1)

    def test_goal_sent_while_paused_is_accepted_and_reached_afterwards(self):
        call_simulator("pause")
        goal = self.goals.send(0.2, 0.0)
        self.goals.log.wait_for(lambda m: m.msg.startswith("goal accepted"), "the goal's acceptance")
        call_simulator("unpause")
        goal.result("REACHED")


if __name__ == "__main__":
    run(Pause)
