#!/usr/bin/env python3
"""While the simulator is paused, time and robot stand still, and goals and cancels are still served."""

import rospy
from dynamic_reconfigure.client import Client
from harness import SIMULATOR, Recorder, SystemTest, call_simulator, distance, run, wait_for
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.geometry import Pose2D

FAR = Pose2D(0.83, -0.56)  # in odom: 1 m of free way, to which the robot drives for five seconds


class Pause(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clock = Recorder("/clock", Clock)
        client = Client(SIMULATOR[1:], timeout=60)
        client.update_configuration({"real_time_factor": 1.0})  # so that it still drives when it is paused
        cls.addClassCleanup(client.update_configuration, {"real_time_factor": 4.0})  # of the launch file

    def tearDown(self):
        call_simulator("unpause")
        super().tearDown()

    def pause_while_driving(self):
        """Pause while the robot drives to a goal; the goal, and the time of the pause."""
        goal = self.goals.send(FAR.x, FAR.y)
        self.robot.wait_until_it_drives(0.1)
        answer = call_simulator("pause")
        self.assertRegex(answer, r"^paused at \d+\.\d+ s$")
        seconds = float(answer.split()[2])
        paused_at = self.clock.wait_for(lambda m: abs(m.clock.to_sec() - seconds) < 0.001, answer).clock
        wait_for(lambda: rospy.get_rostime() == paused_at, "the clock at the pause")
        return goal, paused_at

    def test_time_stops_while_paused_and_then_time_and_goal_go_on_from_there(self):
        goal, paused_at = self.pause_while_driving()
        self.assertEqual({m.clock for m in self.clock.next(5)}, {paused_at})  # repeated for nodes that start meanwhile
        call_simulator("unpause")
        first = self.robot.odom.wait_for(lambda m: m.header.stamp > paused_at, "odometry after the pause")
        self.assertLess((first.header.stamp - paused_at).to_sec(), 0.05)
        goal.result("REACHED")
        self.robot.wait_until_it_stands()
        self.assertLess(distance(self.robot.odom_pose(), FAR), 0.1)

    def test_goal_sent_while_paused_is_accepted_and_reached_afterwards(self):
        call_simulator("pause")
        goal = self.goals.send(0.2, 0.0)
        self.goals.log.wait_for(lambda m: m.msg.startswith("goal accepted"), "the goal's acceptance")
        call_simulator("unpause")
        goal.result("REACHED")


if __name__ == "__main__":
    run(Pause)
