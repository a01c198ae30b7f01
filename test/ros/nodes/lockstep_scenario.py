#!/usr/bin/env python3
"""A scripted run in lockstep: a goal is reached, one is preempted, one ends at an obstacle.

Usage: lockstep_scenario.py RESULT.json. The result holds the outcomes and a digest of all messages. Time advances
only by ~step, and goals are sent while it stands, so the run is the same on any machine.
"""

import hashlib
import io
import json
import sys

import rospy
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult, SimStatus
from aro_robocop_goto_as.srv import Step
from harness import ACTION, SERVER, SIMULATOR, Goals, Recorder, wait_for, wait_for_connection
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

RECORDED = {
    "/ground_truth_odom": Odometry,
    "/odom": Odometry,
    "/scan": LaserScan,
    "/robocop_goto_as/feedback": GoToPositionActionFeedback,
    "/robocop_goto_as/result": GoToPositionActionResult,
}
# Goal in odom [m], and the time [s] before the next one is sent. The second goal is preempted by the third.
GOALS = [((0.4, 0.0), 5.0), ((0.5, -0.8), 2.0), ((1.1, 0.55), 6.0)]
WARM_UP = 1.0  # [s] for every node to receive the clock, and for lockstep to learn the period of each topic


def raw(message):
    """A message in its serialized form."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Scenario:
    def __init__(self):
        self.status = Recorder(f"{SIMULATOR}/status", SimStatus)
        self.recorders = {topic: Recorder(topic, kind) for topic, kind in RECORDED.items()}
        for topic in RECORDED:
            wait_for_connection(SERVER if ACTION in topic else SIMULATOR, topic)
        wait_for(
            lambda: self.status.messages and self.status.messages[-1].drivers == [SERVER],
            "lockstep waits for the server",
        )
        self.step_service = rospy.ServiceProxy(f"{SIMULATOR}/step", Step)
        self.step_service.wait_for_service(60.0)

    def step(self, seconds):
        """Advance time, and wait until this node has received it, as it stamps the goals."""
        answer = self.step_service(seconds)
        assert answer.success, answer.message
        wait_for(lambda: rospy.get_rostime() >= answer.stamp, "the clock")
        return answer.stamp

    def run(self):
        self.step(WARM_UP)
        goals = Goals()
        given = []
        for (x, y), seconds in GOALS:
            given.append(goals.send(x, y))
            wait_for(lambda: GoalStatus.ACTIVE in given[-1].states(), f"goal {len(given)} is accepted")
            end = self.step(seconds)
        words = [goal.result().result.message.split(":")[0] for goal in given]
        wait_for(lambda: any(m.feedback.message == "obstacle" for m in given[-1].feedback()), "the last feedback")
        for topic in ("/ground_truth_odom", "/odom", "/scan"):
            self.recorders[topic].wait_for(lambda m: m.header.stamp == end, "the last message")
        goals.assert_each_ended_once()
        return words

    def summary(self, words):
        """The summary by which two runs are compared."""
        content = {topic: b"".join(map(raw, recorder.messages)) for topic, recorder in self.recorders.items()}
        return {
            "words": words,
            "misses": self.status.messages[-1].lockstep_misses,
            "counts": {topic: len(recorder) for topic, recorder in self.recorders.items()},
            "digests": {topic: hashlib.sha256(data).hexdigest() for topic, data in content.items()},
        }


def main():
    rospy.init_node("scenario")
    scenario = Scenario()
    summary = scenario.summary(scenario.run())
    with open(sys.argv[1], "w") as result:
        json.dump(summary, result)


if __name__ == "__main__":
    main()
