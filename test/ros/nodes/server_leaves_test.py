#!/usr/bin/env python3
"""A server that another one of its name replaces, or whose clock is set back, ends its goal and leaves."""

import unittest

import rosgraph
import rospy
from fake_robot import FakeRobot
from geometry_msgs.msg import Twist
from harness import ACTION, SERVER, Process, run, script, wait_for, wait_for_connection


class ServerLeaves(unittest.TestCase):
    def test_a_second_server_of_the_same_name_serves_the_next_goal(self):
        robot = FakeRobot()
        robot.renew()
        goal = robot.start(2.0, 0.0)
        for _ in range(5):
            self.assertTrue(robot.tick(goal))
        links = robot.links()
        first = rosgraph.Master(rospy.get_name()).lookupNode(SERVER)
        with Process(script("robocop_goto_as.py"), f"__name:={SERVER[1:]}") as second:
            self.assertIn("server is shutting down", goal.result("SHUTDOWN").result.message)
            master = rosgraph.Master(rospy.get_name())
            subscribers = wait_for(
                lambda: dict(master.getSystemState()[1]).get("/robocop_goto_as/cancel"),
                lambda: (
                    f"a server that subscribes; the second one's status is {second.process.poll()}: {second.output}"
                ),
            )
            self.assertEqual(subscribers, [SERVER])
            self.assertNotEqual(master.lookupNode(SERVER), first)
            # Both servers have one name: a second robot would send its first messages to the first server.
            wait_for(lambda: not links & robot.links(), "the end of the first server's connections")
            robot = FakeRobot()
            robot.renew()
            for topic in (f"{ACTION}/feedback", f"{ACTION}/result", "cmd_vel", "/rosout"):
                wait_for_connection(SERVER, topic)
            following = robot.start(robot.pose.x + 0.3, 0.0)
            robot.follow(following)
            robot.end(following, "REACHED")
            self.assertIsNone(second.process.poll())

    def test_clock_that_is_set_back_ends_the_goal_and_the_server_with_exit_status_1(self):
        with Process(script("robocop_goto_as.py"), f"__name:={SERVER[1:]}") as server:
            robot = FakeRobot()
            robot.pass_time(1000.0)
            robot.renew()
            goal = robot.start(2.0, 0.0)
            self.assertTrue(robot.tick(goal))
            robot.now_ns -= 900 * 1000000000
            robot.pass_time(0.1)
            reason = r"simulated time was set back from \d+\.\d to \d+\.\d s"
            self.assertRegex(goal.result("SHUTDOWN").result.message, f"{reason}$")
            self.assertEqual(robot.commands.messages[-1], Twist())
            self.assertEqual(server.wait_for_exit(), 1, server.output)
            self.assertRegex(server.output, f"CLOCK: {reason}")


if __name__ == "__main__":
    run(ServerLeaves)
