"""Goals at actionlib's server: obstacles, cancels, replaced and outdated goals, and parameters that are changed.

What else ends a goal is in faults_test.py and in test/unit/ros/server.
"""

import math

import rospy
from actionlib_msgs.msg import GoalStatus
from dynamic_reconfigure.client import Client
from harness import DEADLINE, SERVER, SystemTest, call_simulator, wait_for

from aro_robocop_goto_as.goto.params import GotoParams


class Server(SystemTest):
    def send_while_the_clock_is_stopped(self):
        """A goal that is executed and has not had a control period."""
        call_simulator("pause")
        self.addCleanup(call_simulator, "unpause")
        goal = self.goals.send(2.0, 0.0)
        wait_for(lambda: GoalStatus.ACTIVE in goal.states(), "a goal that is executed")
        return goal

    def tune(self, values):
        """Change parameters for one test; the values in force."""
        tuning = Client(SERVER, timeout=DEADLINE)
        self.addCleanup(tuning.update_configuration, {name: getattr(GotoParams(), name) for name in values})
        return tuning.update_configuration(values)

    def test_obstacle_ahead_ends_the_goal_and_stops_the_robot(self):
        text = self.goals.send(1.6, 0.73).result("OBSTACLE").result.message  # behind pillar_1
        self.assertRegex(text, r"obstacle 0\.2\d\d m ahead \(limit 0\.3 m\); \d\.\d+ m from the goal x 1\.60 y 0\.73 ")
        self.robot.wait_until_it_stands()

    def test_goal_that_is_no_position_is_aborted_at_once_and_the_robot_stays(self):
        for x in (math.nan, math.inf, -1e39):
            text = self.goals.send(x, 0.0).result("BAD_GOAL").result.message
            self.assertIn(f"position x {x} y 0.0: expected finite numbers in metres", text)
        self.assertEqual({message.linear.x for message in self.robot.commands.messages}, {0.0})

    def test_goal_without_progress_ends(self):
        self.tune({"min_linear_velocity": 0.001, "max_linear_velocity": 0.001})
        self.goals.send(0.6, 0.0).result("STUCK")

    def test_cancel_is_served_while_the_clock_is_stopped(self):
        goal = self.send_while_the_clock_is_stopped()
        goal.cancel()
        self.assertIn("it was cancelled", goal.result("PREEMPTED").result.message)

    def test_replaced_goals_each_end_once_and_those_that_never_began_as_actionlib_ends_them(self):
        first = self.send_while_the_clock_is_stopped()
        waiting = [self.goals.send(2.0, 0.1 * number) for number in range(20)]
        newest = self.goals.send(0.3, 0.1)
        self.assertIn("a newer goal replaced it", first.result("PREEMPTED").result.message)
        call_simulator("unpause")
        newest.result("REACHED")
        ended = [goal.result() for goal in waiting]
        self.assertLessEqual({m.status.status for m in ended}, {GoalStatus.PREEMPTED, GoalStatus.RECALLED})
        recalled = [m.result.message for m in ended if m.status.status == GoalStatus.RECALLED]
        self.assertLessEqual(set(recalled), {""})

    def test_goal_stamped_before_the_current_one_is_recalled_and_the_current_one_goes_on(self):
        current = self.goals.send(0.6, 0.0)
        self.robot.wait_until_it_drives()
        stamped_earlier = self.goals.send(0.1, 0.1, stamp=rospy.Time(0, 1))  # of a client whose clock is behind
        self.assertEqual(stamped_earlier.result().status.status, GoalStatus.RECALLED)
        current.result("REACHED")

    def test_changed_parameters_hold_for_the_goal_that_is_executed_and_contradictions_are_refused(self):
        goal = self.send_while_the_clock_is_stopped()
        shown = self.tune({"max_linear_velocity": 0.16})
        self.assertEqual((shown["max_linear_velocity"], rospy.get_param(f"{SERVER}/max_linear_velocity")), (0.16, 0.16))
        self.goals.log.wait_for(lambda m: "max_linear_velocity 0.16, was 0.2" in m.msg, "the change")
        shown = self.tune({"min_linear_velocity": 0.5, "linear_gain": 1.0})
        self.assertEqual((shown["min_linear_velocity"], shown["linear_gain"]), (0.03, 0.5))
        refused = "min_linear_velocity: expected at most max_linear_velocity 0.16, got 0.5; nothing is changed"
        self.goals.log.wait_for(lambda m: refused in m.msg, "a refusal")
        call_simulator("unpause")
        goal.result("REACHED")
        self.assertEqual(max(message.linear.x for message in self.robot.commands.messages), 0.16)
