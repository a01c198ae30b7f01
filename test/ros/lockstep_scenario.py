#!/usr/bin/env python3
"""A scripted run on a simulator in lockstep, with every byte of what it published: three goals that are reached, one
that an obstacle ends, one that a newer goal replaces. Usage: lockstep_scenario.py RESULT.json [BAG]

Time is moved on by ~step only, and goals are given while it stands, so that the run is the same on any machine.
"""

import hashlib
import io
import json
import sys

import rosbag
import rospy
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult, SimStatus
from aro_robocop_goto_as.srv import Step
from harness import SERVER, SIMULATOR, Goals, Recorder, wait_for
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

RECORDED = {
    "/ground_truth_odom": Odometry, "/odom": Odometry, "/scan": LaserScan,
    "/robocop_goto_as/feedback": GoToPositionActionFeedback, "/robocop_goto_as/result": GoToPositionActionResult}
# Where to (odom) [m], and for how long [s] time goes on before the next one: the third is replaced on its way.
GOALS = [((1.0, 0.0), 10.0), ((1.0, -0.8), 10.0), ((0.2, -0.5), 2.0), ((0.5, 0.3), 10.0), ((1.1, 0.55), 5.0)]
WORDS = ["REACHED", "REACHED", "PREEMPTED", "REACHED", "OBSTACLE"]
WARM_UP = 1.0  # [s] so that every node has seen time move, and knows each topic's period


def raw(message):
    """A message as it goes over the wire."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Scenario:
    def __init__(self):
        self.status = Recorder(f"{SIMULATOR}/status", SimStatus)
        self.recorders = {topic: Recorder(topic, kind) for topic, kind in RECORDED.items()}
        wait_for(lambda: self.status.messages and self.status.messages[-1].drivers == [SERVER],
                 "lockstep waits for the server")
        self.step_service = rospy.ServiceProxy(f"{SIMULATOR}/step", Step)
        self.step_service.wait_for_service(60.0)

    def step(self, seconds):
        """Move time on, and wait until it has come to this node too: it stamps the goals."""
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
        goals.check_ends()
        return words

    def summary(self, words):
        """What a run is compared by."""
        content = {topic: b"".join(map(raw, it.messages)) for topic, it in self.recorders.items()}
        return {
            "words": words,
            "misses": self.status.messages[-1].lockstep_misses,
            "counts": {topic: len(it) for topic, it in self.recorders.items()},
            "digests": {topic: hashlib.sha256(data).hexdigest() for topic, data in content.items()},
        }

    def write_bag(self, path):
        with rosbag.Bag(path, "w") as bag:
            for topic, it in self.recorders.items():
                for message, time in zip(it.messages, it.times):
                    bag.write(topic, message, rospy.Time.from_sec(max(time, 1e-3)))


def main():
    rospy.init_node("scenario")
    scenario = Scenario()
    summary = scenario.summary(scenario.run())
    if len(sys.argv) > 2:
        scenario.write_bag(sys.argv[2])
    with open(sys.argv[1], "w") as result:
        json.dump(summary, result)


if __name__ == "__main__":
    main()
