#!/usr/bin/env python3
"""Writes the true poses to a file, one a line, as exact hexadecimal floats. Usage: trajectory.py FILE"""

import sys

import rospy
from harness import SIMULATOR, wait_for, wait_for_connection
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
    wait_for_connection(SIMULATOR, topic.name)
    open(sys.argv[1], "w").close()
    rospy.spin()


if __name__ == "__main__":
    main()
