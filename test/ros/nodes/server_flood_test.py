#!/usr/bin/env python3
"""Thousands of goals at once: the newest one supersedes all others, each of which ends exactly once."""

import time
import unittest
from collections import Counter

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionGoal, GoToPositionActionResult
from fake_robot import FakeRobot
from harness import ACTION, SERVER, run, wait_for, wait_for_connection, wait_for_subscriber

FLOOD = 6000  # goals
DEADLINE = 120.0  # [s, wall] for their results; the launch file's time-limit is 150 s
STATUSES = 402  # in one message: what the server keeps of ended goals, at most twice, and two that have not ended


class ServerFlood(unittest.TestCase):
    def setUp(self):
        self.results, self.longest_status = [], 0
        self.subscribers = [
            rospy.Subscriber(f"{ACTION}/result", GoToPositionActionResult, self.results.append),
            rospy.Subscriber(f"{ACTION}/status", GoalStatusArray, self.on_status),
        ]
        self.flood = rospy.Publisher(f"{ACTION}/goal", GoToPositionActionGoal, queue_size=2 * FLOOD)
        wait_for_subscriber(self.flood, SERVER)
        wait_for_connection(SERVER, f"{ACTION}/result")
        self.robot = FakeRobot()
        self.robot.renew()

    def on_status(self, message):
        self.longest_status = max(self.longest_status, len(message.status_list))

    def send(self, name, x=2.0):
        message = GoToPositionActionGoal(goal_id=GoalID(rospy.Time(), name))
        message.goal.position.x = x
        self.flood.publish(message)

    def test_newest_goal_supersedes_all_others_and_is_reached(self):
        names = [f"flood-{number}" for number in range(FLOOD)]
        began = time.monotonic()
        for name in names:
            self.send(name)
        sent = time.monotonic()
        newest = self.robot.goals.send(0.5, 0.0)  # by a connection of its own, so it may be accepted before the others
        self.send("last", 0.3)
        wait_for(lambda: len(self.results) >= FLOOD, lambda: f"a result for each goal: {len(self.results)}", DEADLINE)
        print(f"{FLOOD} goals sent in {sent - began:.1f} s, ended {time.monotonic() - sent:.1f} s later", flush=True)
        wait_for(lambda: self.robot.pass_time(0.1) or len(self.results) == FLOOD + 2, "the end of the newest goals")
        self.assertEqual(
            Counter(message.status.goal_id.id for message in self.results), Counter([*names, newest.id, "last"])
        )
        superseded = [message for message in self.results if message.status.goal_id.id in names]
        self.assertLessEqual(
            {message.status.status for message in superseded}, {GoalStatus.PREEMPTED, GoalStatus.RECALLED}
        )
        self.assertEqual({message.result.message.split()[0] for message in superseded}, {"PREEMPTED:"})
        self.assertLessEqual(self.longest_status, STATUSES)


if __name__ == "__main__":
    run(ServerFlood)
