#!/usr/bin/env python3
"""A bridge without its server says so, names the one that was misspelt, and keeps the goal until its server comes."""

import threading
import unittest

import actionlib
from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionResult
from clicks import Clicks
from harness import ACTION, run, wait_for

MISSPELT = "robovop_goto_as"


class Server:
    """An action server that reaches every goal once it is told to."""

    def __init__(self, name):
        self.goals = []
        self.finish = threading.Event()
        self.server = actionlib.SimpleActionServer(name, GoToPositionAction, self._execute, auto_start=False)
        self.server.start()

    def _execute(self, goal):
        self.goals.append(goal)
        self.finish.wait()
        self.server.set_succeeded(GoToPositionResult(True, "REACHED: by the test"))


class BridgeWaits(unittest.TestCase):
    def test_missing_server_is_told_a_misspelt_one_is_named_and_the_goal_is_kept_for_the_right_one(self):
        clicks = Clicks()
        clicks.wait_for_status(f"waiting for {ACTION}")
        self.assertEqual({m.data for m in clicks.status.messages}, {f"waiting for {ACTION}"})

        misspelt = Server(MISSPELT)
        told = clicks.wait_for_status(MISSPELT)
        self.assertEqual(told, f"waiting for {ACTION}; there is '/{MISSPELT}' of the same type: a misspelt name?")

        clicks.click(5.0, 5.0, "odom")
        clicks.click(0.5, 0.25, "odom")
        right = Server(ACTION)
        wait_for(lambda: right.goals, "the goal at the right server")
        clicks.wait_for_status("goal x 0.50 y 0.25 is ")
        right.finish.set()
        clicks.wait_for_status(f"{ACTION} is ready, last goal SUCCEEDED: REACHED: by the test")
        self.assertEqual([(goal.position.x, goal.position.y) for goal in right.goals], [(0.5, 0.25)])
        self.assertEqual(misspelt.goals, [])


if __name__ == "__main__":
    run(BridgeWaits)
