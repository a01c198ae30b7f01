#!/usr/bin/env python3
"""A controller unaware of lockstep, as a student may write it: a rospy.Rate loop that publishes cmd_vel."""

import math

import rospy
from geometry_msgs.msg import Twist
from harness import wait_for

STARTS_AT = 5.0  # [s] it commands standstill before, as lockstep follows a loop from its third command on


def main():
    rospy.init_node("metronome")
    publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    wait_for(publisher.get_num_connections, "a subscriber of cmd_vel")
    rate = rospy.Rate(rospy.get_param("~rate", 10))
    while not rospy.is_shutdown():
        command = Twist()
        if rospy.get_time() >= STARTS_AT:
            command.linear.x = 0.1 + 0.1 * math.sin(rospy.get_time())
            command.angular.z = 0.5 * math.cos(rospy.get_time() / 2.0)
        publisher.publish(command)
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
