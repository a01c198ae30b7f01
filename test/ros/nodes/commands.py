"""Publishing velocity commands from a test."""

import contextlib
import threading

import rospy
from geometry_msgs.msg import Twist
from harness import SIMULATOR, wait_for_subscriber

PERIOD = 0.05  # [s, wall]


class Commands:
    """Publishes cmd_vel: a single command, or one repeated as by teleoperation."""

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

    @contextlib.contextmanager
    def repeated(self, v, w=0.0):
        """Publish one command [m/s, rad/s] every PERIOD during the block."""
        stop = threading.Event()

        def repeat():
            self.once(v, w)
            while not stop.wait(PERIOD):
                self.once(v, w)

        thread = threading.Thread(target=repeat, daemon=True)
        thread.start()
        try:
            yield
        finally:
            stop.set()
            thread.join()
