"""A robot made of messages only. Its clock advances only when a test lets it, in step with the server.

So a test knows at which simulated time the server did something, however busy the machine is.
"""

import io
import math
import xmlrpc.client

import rosgraph
import rospy
from geometry_msgs.msg import Twist
from harness import ACTION, SERVER, Goals, Recorder, wait_for, wait_for_subscriber
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.ros.convert import to_quaternion

PERIOD_NS = 100000000  # of the server's control loop
PERIOD = 0.1  # [s]
RANGE_MIN, RANGE_MAX = 0.12, 10.0  # [m]
BEAMS = 360
INCREMENT = 2.0 * math.pi / BEAMS


class FakeRobot:
    """Publishes clock, odom and scan. `pose` follows cmd_vel exactly while `obeys` is True."""

    def __init__(self):
        self.goals = Goals()
        self.now_ns = 0
        self.pose = Pose2D()
        self.obeys = True
        self.ranges = [math.inf] * BEAMS  # counter-clockwise from straight ahead
        self.commands = Recorder("cmd_vel", Twist)
        self.log = Recorder("/rosout", Log, wait=False)
        self._clock = rospy.Publisher("/clock", Clock, queue_size=1000)
        self._odom = rospy.Publisher("odom", Odometry, queue_size=1000)
        self._scan = rospy.Publisher("scan", LaserScan, queue_size=1000)
        for publisher in (self._clock, self._odom, self._scan):
            wait_for_subscriber(publisher, SERVER)
        wait_for_subscriber(self._clock, rospy.get_name())
        self._server = xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(SERVER))
        self._bytes = 0
        self.pass_time(1.0)
        wait_for(
            lambda: [messages for _, _, messages, *_ in self._connections()] == [1, 1, 1],
            "one message of each topic at the server, and none from an earlier fake robot",
        )
        # Bytes received by the server once everything published has arrived; rospy does not count messages it drops.
        self._bytes = self._received()

    # -- pose and scan --

    def renew(self):
        """Return to the origin of odom with an empty scan, and drop what was recorded."""
        self.pose, self.obeys = Pose2D(), True
        self.ranges = [math.inf] * BEAMS
        self.pass_time(PERIOD)
        self.settle()
        self.goals.clear()

    def see(self, distance, degrees):
        """Set the ranges at these angles, 0 = straight ahead, to a distance [m] or a special value."""
        for angle in degrees:
            self.ranges[angle % BEAMS] = distance
        self.settle()

    def settle(self):
        """Publish odometry and scan, and wait until the server has received them."""
        self._wait_for_server()
        self._publish_odom()
        self._publish_scan()
        self._wait_for_server()

    # -- time --

    @property
    def now(self):
        """Simulated time."""
        return rospy.Time(self.now_ns // 1000000000, self.now_ns % 1000000000)

    def pass_time(self, seconds):
        """Advance the clock at once, publish odometry and scan, and wait until this node has received the clock."""
        self.now_ns += int(round(seconds / PERIOD)) * PERIOD_NS
        self._publish_odom()
        self._publish_scan()
        self._publish(self._clock, Clock(self.now))
        wait_for(lambda: rospy.get_rostime() == self.now, "the clock")

    # -- goals --

    def start(self, x, y):
        """Send a goal in odom [m] and wait until it is accepted: the next clock tick is its first control period.

        The commands and logs recorded before are dropped.
        """
        self.commands.clear()
        self.log.clear()
        goal = self.goals.send(x, y)
        wait_for(
            lambda: any(m.name == SERVER and m.msg.startswith("goal accepted") for m in self.log.messages),
            f"goal {goal.id} accepted by {ACTION}",
        )
        return goal

    def tick(self, goal):
        """One control period: publish, wait for the command, follow it; False once the goal has ended.

        The last feedback is published just before the result, so the end may be seen only at the next tick.
        """
        self.pass_time(PERIOD)
        wait_for(lambda: goal.results() or self._answered(goal), f"an answer for goal {goal.id} at {self.now.to_sec()}")
        if goal.results():
            return False
        if self.obeys:
            twist = self.commands.messages[-1]
            self.pose = compose(
                compose(self.pose, Pose2D(yaw=twist.angular.z * PERIOD)), Pose2D(twist.linear.x * PERIOD)
            )
        return True

    def _answered(self, goal):
        feedback = goal.feedback()
        return feedback and feedback[-1].header.stamp == self.now and len(self.commands) == len(feedback)

    def follow(self, goal, seconds=60.0):
        """Tick until a goal has ended; the simulated time it took [s], at most `seconds`."""
        start = self.now
        while self.tick(goal):
            passed = (self.now - start).to_sec()
            assert passed < seconds, f"goal {goal.id} is still active after {passed} s: {goal.feedback()[-1].feedback}"
        return (self.now - start).to_sec()

    def end(self, goal, word):
        """Wait for the end of a goal with this outcome and for its command of zero; the result."""
        result = goal.result(word)
        wait_for(lambda: self.commands.messages[-1:] == [Twist()], "a last command of zero")
        return result

    # -- messages --

    def _publish_odom(self):
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = self.now, "odom", "base_footprint"
        message.pose.pose.position.x, message.pose.pose.position.y = self.pose.x, self.pose.y
        message.pose.pose.orientation = to_quaternion(self.pose.yaw)
        self._publish(self._odom, message)

    def _publish_scan(self):
        message = LaserScan(
            angle_min=0.0,
            angle_max=INCREMENT * (BEAMS - 1),
            angle_increment=INCREMENT,
            range_min=RANGE_MIN,
            range_max=RANGE_MAX,
            ranges=list(self.ranges),
        )
        message.header.stamp, message.header.frame_id = self.now, "base_scan"
        self._publish(self._scan, message)

    def _publish(self, publisher, message):
        publisher.publish(message)
        content = io.BytesIO()
        message.serialize(content)
        self._bytes += 4 + content.tell()  # TCPROS sends the length before each message

    def _wait_for_server(self):
        wait_for(lambda: self._received() == self._bytes, "everything published at the server")

    def _connections(self):
        """The server's connections on clock, odom and scan: id, bytes received, messages received, ..."""
        _, _, (_, subscriptions, _) = self._server.getBusStats(rospy.get_name())
        return [
            connection
            for topic, connections in subscriptions
            for connection in connections
            if topic in ("/clock", "/odom", "/scan")
        ]

    def _received(self):
        """Bytes that the server has received on clock, odom and scan."""
        return sum(connection[1] for connection in self._connections())
