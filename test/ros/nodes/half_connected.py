#!/usr/bin/env python3
"""Answers ticks while its subscription to /scan stays unconnected, until a line arrives on standard input."""

import sys

import rosgraph
import rospy
from aro_robocop_goto_as.msg import TickAnswer
from harness import wait_for
from sensor_msgs.msg import LaserScan


def main():
    rospy.init_node("half_connected", disable_rostime=True)
    # As rospy registers it, but nobody connects to the publishers that the master returns.
    rosgraph.Master(rospy.get_name()).registerSubscriber("/scan", LaserScan._type, rospy.get_node_uri())
    answers = rospy.Publisher("tick_answer", TickAnswer, queue_size=1)
    wait_for(answers.get_num_connections, "the simulator connects")
    print("ready", flush=True)
    sys.stdin.readline()
    rospy.Subscriber("scan", LaserScan, lambda message: None)
    rospy.spin()


if __name__ == "__main__":
    main()
