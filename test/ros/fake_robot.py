"""A robot of nothing but messages: its clock stands still unless a test lets time pass, step by step with the server.

With it a test knows at which simulated moment the server did what, however busy the machine is.
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
from aro_robocop_goto_as.nodes.convert import to_quaternion

PERIOD_NS = 100000000  # of the server's control loop
PERIOD = 0.1  # [s]
RANGE_MIN, RANGE_MAX = 0.12, 10.0  # [m]
BEAMS = 360
INCREMENT = 2.0 * math.pi / BEAMS


class FakeRobot:
    """Publishes clock, odom and scan; `pose` follows cmd_vel exactly, unless `obeys` is False."""

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
        wait_for(lambda: [messages for _, _, messages, *_ in self._connections()] == [1, 1, 1],
                 "the first of each topic at the server, and nothing more from another robot before this one")
        self._bytes = self._received()  # that the server will have received once all that was sent has arrived

    # -- what the robot is and sees --

    def renew(self):
        """Odom's origin, nothing in sight, no past."""
        self.pose, self.obeys = Pose2D(), True
        self.ranges = [math.inf] * BEAMS
        self.pass_time(PERIOD)
        self.settle()
        self.goals.forget()

    def see(self, distance, degrees):
        """Put a return [m] (or anything else that a scan may hold) into the beams at these angles, 0 = ahead."""
        for angle in degrees:
            self.ranges[angle % BEAMS] = distance
        self.settle()

    def stand_at(self, pose):
        """Be somewhere else."""
        self.pose = pose
        self.settle()

    def settle(self):
        """Publish what there is to measure now, and wait until the server has received it."""
        self._wait_for_server()
        self._publish_odom()
        self._publish_scan()
        self._wait_for_server()

    # -- time --

    @property
    def now(self):
        """Simulated time."""
        return rospy.Time(self.now_ns // 1000000000, self.now_ns % 1000000000)

    def pass_time(self, seconds, odom=True, scan=True):
        """Let this much time pass in one go, and measure at its end; wait until this node itself has heard of it."""
        self.now_ns += int(round(seconds / PERIOD)) * PERIOD_NS
        if odom:
            self._publish_odom()
        if scan:
            self._publish_scan()
        self._publish(self._clock, Clock(self.now))
        wait_for(lambda: rospy.get_rostime() == self.now, "the clock")

    # -- goals --

    def send(self, x, y, z=0.0):
        """A goal in odom [m]; what was commanded and logged before is forgotten."""
        self.commands.forget()
        self.log.forget()
        return self.goals.send(x, y, z)

    def start(self, x, y, z=0.0):
        """A goal that the server pursues: the next tick of the clock is its first."""
        goal = self.send(x, y, z)
        self.wait_for_acceptance(goal)
        return goal

    def wait_for_acceptance(self, goal):
        """Until the server pursues it."""
        wait_for(lambda: any(m.name == SERVER and m.msg.startswith("goal accepted") for m in self.log.messages),
                 f"goal {goal.id} accepted by {ACTION}")

    def tick(self, goal, **silent):
        """One control period: measure, let the server answer, move as commanded; False once the goal has ended.

        The last feedback comes just before the result, so the end may show only on the tick after it.
        """
        self.pass_time(PERIOD, **silent)
        wait_for(lambda: goal.results() or self._answered(goal), f"an answer for goal {goal.id} at {self.now.to_sec()}")
        if goal.results():
            return False
        if self.obeys:
            twist = self.commands.messages[-1]
            self.pose = compose(compose(self.pose, Pose2D(yaw=twist.angular.z * PERIOD)),
                                Pose2D(twist.linear.x * PERIOD))
        return True

    def _answered(self, goal):
        feedback = goal.feedback()
        return feedback and feedback[-1].header.stamp == self.now and len(self.commands) == len(feedback)

    def follow(self, goal, seconds=60.0, **silent):
        """Tick until a goal has ended, for this long at the most; how long it took [s]."""
        start = self.now
        while self.tick(goal, **silent):
            passed = (self.now - start).to_sec()
            assert passed < seconds, f"goal {goal.id} goes on after {passed} s: {goal.feedback()[-1].feedback}"
        return (self.now - start).to_sec()

    def end(self, goal, word):
        """Wait for the goal's end, as this word says, and for the command to stand that comes with it; the result."""
        result = goal.result(word)
        wait_for(lambda: self.commands.messages[-1:] == [Twist()], "the last command is to stand")
        return result

    # -- messages --

    def _publish_odom(self):
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = self.now, "odom", "base_footprint"
        message.pose.pose.position.x, message.pose.pose.position.y = self.pose.x, self.pose.y
        message.pose.pose.orientation = to_quaternion(self.pose.yaw)
        self._publish(self._odom, message)

    def _publish_scan(self):
        message = LaserScan(angle_min=0.0, angle_max=INCREMENT * (BEAMS - 1), angle_increment=INCREMENT,
                            range_min=RANGE_MIN, range_max=RANGE_MAX, ranges=list(self.ranges))
        message.header.stamp, message.header.frame_id = self.now, "base_scan"
        self._publish(self._scan, message)

    def _publish(self, publisher, message):
        publisher.publish(message)
        content = io.BytesIO()
        message.serialize(content)
        self._bytes += 4 + content.tell()  # TCPROS puts the length before each message

    def _wait_for_server(self):
        wait_for(lambda: self._received() == self._bytes, "all that was published at the server")

    def _connections(self):
        """The server's connections for clock, odom and scan: id, bytes and messages received, ..."""
        _, _, (_, subscriptions, _) = self._server.getBusStats(rospy.get_name())
        return [connection for topic, connections in subscriptions for connection in connections
                if topic in ("/clock", "/odom", "/scan")]

    def _received(self):
        """Bytes of clock, odom and scan that the server has received so far."""
        return sum(connection[1] for connection in self._connections())
