#!/usr/bin/env python3
"""Writes the true poses to a file, a line each, to the last bit. Usage: trajectory.py FILE"""

import sys

import rospy
from harness import wait_for
from nav_msgs.msg import Odometry


def main():
    rospy.init_node("trajectory", disable_rostime=True)
    lines = []

    def on_truth(message):
        p, q = message.pose.pose.position, message.pose.pose.orientation
        lines.append(" ".join(value.hex() for value in (p.x, p.y, q.z, q.w)) + "\n")
        with open(sys.argv[1], "a") as output:
            output.write(lines[-1])

    topic = rospy.Subscriber("ground_truth_odom", Odometry, on_truth)
    wait_for(topic.get_num_connections, "the simulator")
    open(sys.argv[1], "w").close()
    rospy.spin()


if __name__ == "__main__":
    main()
