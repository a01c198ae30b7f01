"""Publishing velocity commands from a test."""

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

    def repeated(self, v, w=0.0):
        """A context in which one command [m/s, rad/s] is published every PERIOD."""
        return _Repeated(self, v, w)


class _Repeated:
    def __init__(self, commands, v, w):
        self._commands, self._twist = commands, (v, w)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._repeat, daemon=True)

    def _repeat(self):
        while not self._stop.wait(PERIOD):
            self._commands.once(*self._twist)

    def __enter__(self):
        self._commands.once(*self._twist)
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
