"""Publishing velocity commands from a test."""

import rospy
from geometry_msgs.msg import Twist
from harness import SIMULATOR, wait_for_subscriber


class Commands:
    """Publishes cmd_vel: one at a time."""

    def __init__(self, topic="cmd_vel"):
        self._topic = rospy.Publisher(topic, Twist, queue_size=10)
        wait_for_subscriber(self._topic, SIMULATOR)

    def to_simulator(self):
        """The socket of the connection to the simulator."""
        return next(c.socket for c in self._topic.impl.connections if c.endpoint_id == SIMULATOR)

    def once(self, v, w=0.0):
        """Publish one command [m/s, rad/s]."""
        twist = Twist()
        twist.linear.x, twist.angular.z = v, w
        self._topic.publish(twist)
