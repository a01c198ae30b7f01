#!/usr/bin/env python3
"""A second server of the same name takes over during a goal: the first one ends its goal, the second one serves."""

import unittest

import rosgraph
import rospy
from fake_robot import FakeRobot
from harness import ACTION, SERVER, Process, run, script, wait_for, wait_for_connection


class ServerReplaced(unittest.TestCase):
    def test_second_server_of_the_same_name_serves_the_next_goal(self):
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


if __name__ == "__main__":
    run(ServerReplaced)
