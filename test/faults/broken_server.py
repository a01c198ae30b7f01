#!/usr/bin/env python3
"""The action server with one mistake, which the campaign has to find. Usage: broken_server.py MISTAKE."""

import sys
import time

from aro_robocop_goto_as.geometry import STANDSTILL
from aro_robocop_goto_as.ros.server import goal_execution, node


def second_result():
    """Publishes the result of each goal twice."""
    end = node.GotoNode._end

    def end_twice(server, ending):
        handle = server.goals.current
        end(server, ending)
        state = handle.get_goal_status()
        server.goals.publish_result(state, node.GoToPositionResult(False, ending.message))

    node.GotoNode._end = end_twice


def no_stop():
    """Does not stop the robot when a goal ends."""
    publish = node.GotoNode._publish_command

    def publish_motion(server, twist):
        if twist != STANDSTILL:
            publish(server, twist)

    node.GotoNode._publish_command = publish_motion


def wrong_word():
    """Says REACHED of a goal that was cancelled."""
    goal_execution.Ending.message = property(lambda ending: f"REACHED: {ending.text}")


def traceback():
    """Logs a traceback."""
    print("Traceback (most recent call last):", file=sys.stderr, flush=True)


def leak():
    """Opens files that it does not close."""
    advance = node.GotoNode._advance
    kept = []

    def leak_and_advance(server, tick_ns):
        kept.append(open(__file__, encoding="utf-8"))
        advance(server, tick_ns)

    node.GotoNode._advance = leak_and_advance


def silence():
    """Gives up after one goal."""
    accept = node.GotoNode._accept_goal

    def accept_one(server):
        accept(server)
        node.GotoNode._accept_goal = lambda server: time.sleep(0.1)

    node.GotoNode._accept_goal = accept_one


if __name__ == "__main__":
    globals()[sys.argv[1]]()
    node.main()
