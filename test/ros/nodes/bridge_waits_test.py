#!/usr/bin/env python3
"""A bridge without its server reports that, names a server with a similar name, and keeps the goal for its server."""

import threading
import unittest

import actionlib
import rospy
from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionResult
from clicks import Clicks
from harness import ACTION, BRIDGE, Recorder, run, script, wait_for, wait_for_subscriber
from rosgraph_msgs.msg import Log
from systems import Process

MISSPELT = "robovop_goto_as"


class Server:
    """An action server that reports every goal as reached once `finish` is set."""

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
    def test_missing_server_is_reported_with_a_misspelt_one_and_gets_the_goal_that_waits_but_no_cancelled_one(self):
        bridge = Process(script("robocop_rviz_goto_ac.py"), f"__name:={BRIDGE[1:]}", "_status_period:=0.2")
        self.addCleanup(bridge.__exit__)
        clicks, log = Clicks(), Recorder("/rosout", Log)
        clicks.wait_for_status(f"waiting for {ACTION}")
        self.assertEqual({m.data for m in clicks.status.messages}, {f"waiting for {ACTION}"})
        advice = clicks.wait_for_status("robocop run starts one")
        self.assertEqual(advice, f"waiting for {ACTION}; no simulator is running: ./robocop run starts one")
        log.wait_for(lambda m: m.name == BRIDGE and m.level == Log.WARN and m.msg == advice, "the advice as a warning")

        misspelt = Server(MISSPELT)
        status = clicks.wait_for_status(MISSPELT)
        self.assertIn(f"waiting for {ACTION}; there is '/{MISSPELT}' of the same type: a misspelt name?", status)

        clicks.click(5.0, 5.0, "odom")
        clicks.wait_for_status("goal x 5.00 y 5.00 in odom waits for it")
        cancel = rospy.Publisher(f"{ACTION}/cancel", GoalID, queue_size=1)
        wait_for_subscriber(cancel, BRIDGE)
        cancel.publish(GoalID())
        log.wait_for(lambda m: m.msg.startswith("goal cancelled before its server was up: x 5.00"), "its cancel")
        clicks.click(0.5, 0.25, "odom")
        right = Server(ACTION)
        wait_for(lambda: right.goals, "the goal at the right server")
        clicks.wait_for_status("goal x 0.50 y 0.25 in odom is ")
        right.finish.set()
        clicks.wait_for_status(f"{ACTION} is ready, last goal SUCCEEDED: REACHED: by the test")
        self.assertEqual([(goal.position.x, goal.position.y) for goal in right.goals], [(0.5, 0.25)])
        self.assertEqual(misspelt.goals, [])


if __name__ == "__main__":
    run(BridgeWaits)
