"""2D Nav Goals without RViz: the same message on the same topic, and the bridge's status."""

import rospy
from geometry_msgs.msg import PoseStamped
from harness import BRIDGE, Recorder, wait_for_subscriber
from std_msgs.msg import String


class Clicks:
    """Publishes 2D Nav Goals to the bridge in a namespace; `status` records the bridge's status topic."""

    def __init__(self, namespace=""):
        bridge = namespace + BRIDGE
        self.status = Recorder(f"{bridge}/status", String)
        self._topic = rospy.Publisher(f"{namespace}/move_base_simple/goal", PoseStamped, queue_size=100)
        wait_for_subscriber(self._topic, bridge)

    def click(self, x, y, frame):
        """A 2D Nav Goal at x, y [m] in a frame, stamped with the time of now."""
        message = PoseStamped()
        message.header.frame_id = frame
        message.header.stamp = rospy.Time.now()
        message.pose.position.x, message.pose.position.y = x, y
        message.pose.orientation.w = 1.0
        self._topic.publish(message)

    def wait_for_status(self, text):
        """Wait for a status that contains a text."""
        return self.status.wait_for(lambda m: text in m.data, f"a status with {text!r}").data
