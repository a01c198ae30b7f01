#!/usr/bin/env python3
"""Steps a simulator in lockstep, and more; requests come by standard input: `step SECONDS` or `status`.

Each answer is a line of JSON. One such node costs less than a `rosservice call` for every step.
"""

import json
import sys

import rospy
from aro_robocop_goto_as.msg import SimStatus
from aro_robocop_goto_as.srv import Step
from harness import DEADLINE, SIMULATOR, Recorder


def main():
    rospy.init_node("remote", disable_rostime=True)
    status = Recorder(f"{SIMULATOR}/status", SimStatus)
    step = rospy.ServiceProxy(f"{SIMULATOR}/step", Step)
    step.wait_for_service(DEADLINE)
    for line in sys.stdin:
        request, *arguments = line.split()
        if request == "step":
            answer = step(float(arguments[0]))
            reply = {"success": answer.success, "message": answer.message}
        else:
            (message,) = status.next()  # the report of a second ends after the request
            reply = {"drivers": message.drivers, "lockstep_misses": message.lockstep_misses}
        print(json.dumps(reply), flush=True)


if __name__ == "__main__":
    main()
