"""A controller that knows nothing of lockstep: a rospy loop at 10 Hz, as in a tutorial."""

from typing import Optional

import rospy
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from .cases import ANGULAR, LINEAR

RATE = 10  # [Hz] of simulated time
FIRST = 5  # cycles before the simulator waits for it


class RospyLoop:
    """Stores the newest scan and odometry, and publishes velocity commands."""

    def __init__(self) -> None:
        self.scan: Optional[LaserScan] = None
        self.odom: Optional[Odometry] = None
        rospy.Subscriber("scan", LaserScan, self._on_scan, queue_size=1)
        rospy.Subscriber("odom", Odometry, self._on_odom, queue_size=1)
        self.publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)

    def _on_scan(self, message: LaserScan) -> None:
        self.scan = message

    def _on_odom(self, message: Odometry) -> None:
        self.odom = message

    def run(self) -> None:
        """Publish until the node is shut down; the line on the standard output says that the loop is running."""
        rate = rospy.Rate(RATE)
        cycles = 0
        while not rospy.is_shutdown():
            self.publisher.publish(Twist(Vector3(LINEAR, 0.0, 0.0), Vector3(0.0, 0.0, ANGULAR)))
            rate.sleep()
            cycles += self.scan is not None and self.odom is not None
            if cycles == FIRST:
                print("running", flush=True)


if __name__ == "__main__":
    rospy.init_node("rospy_loop")
    try:
        RospyLoop().run()
    except rospy.ROSInterruptException:
        pass
