#!/usr/bin/env python3
"""Parameters of the server changed by dynamic_reconfigure during a goal: from the next tick on, within their bounds."""

import unittest

import rospy
from dynamic_reconfigure.client import Client
from fake_robot import FakeRobot
from harness import DEADLINE, SERVER, Recorder, run, wait_for
from rosgraph_msgs.msg import Log


class ServerTuning(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = FakeRobot()
        cls.tuning = Client(SERVER, timeout=DEADLINE)
        cls.initial = cls.tuning.get_configuration(timeout=DEADLINE)
        cls.log = Recorder("/rosout", Log)

    def setUp(self):
        self.robot.renew()
        self.log.clear()

    def tearDown(self):
        self.change(**{name: self.initial[name] for name in self.initial if name != "groups"})
        self.robot.goals.assert_each_ended_once()

    def change(self, **values):
        """Request these values; the values in force afterwards, which a tool then shows."""
        return self.tuning.update_configuration(values)

    def start_and_reach_top_speed(self):
        goal = self.robot.start(5.0, 0.0)
        while not self.speeds()[-3:] == [0.2] * 3:
            self.assertTrue(self.robot.tick(goal))
        return goal

    def speeds(self):
        return [message.linear.x for message in self.robot.commands.messages]

    def wait_for_log(self, text):
        wait_for(lambda: any(text in m.msg for m in self.log.messages if m.name == SERVER), f"{text!r} in the log")

    def test_a_lower_maximum_velocity_is_commanded_at_the_next_tick_of_the_current_goal(self):
        goal = self.start_and_reach_top_speed()
        self.assertEqual(self.change(max_linear_velocity=0.16)["max_linear_velocity"], 0.16)
        self.assertEqual(rospy.get_param(f"{SERVER}/max_linear_velocity"), 0.16)
        self.assertEqual(self.speeds()[-1], 0.2)
        self.robot.tick(goal)  # linear_acceleration allows a change of 0.05 m/s
        self.assertEqual(self.speeds()[-2:], [0.2, 0.16])
        self.wait_for_log("max_linear_velocity 0.16, was 0.2")
        goal.cancel()
        self.robot.end(goal, "PREEMPTED")

    def test_values_that_contradict_each_other_are_refused_and_the_tools_show_the_former_ones(self):
        shown = self.change(min_linear_velocity=0.5, linear_gain=1.0)
        self.assertEqual((shown["min_linear_velocity"], shown["linear_gain"]), (0.03, 0.5))
        self.wait_for_log("min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5; nothing is changed")
        self.assertEqual(rospy.get_param(f"{SERVER}/min_linear_velocity"), 0.03)


if __name__ == "__main__":
    run(ServerTuning)
