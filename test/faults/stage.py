"""What time and motion come from: a simulator that runs by itself, or a robot that the campaign makes of messages."""

import contextlib
import math
import time

import rospy
from aro_robocop_goto_as.msg import TickAnswer
from aro_robocop_goto_as.srv import Reset, SetPose, Step
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger
from system import DEADLINE, SIMULATOR, Violation, connections_from, is_connected, publisher, wait_for

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, wrap_angle
from aro_robocop_goto_as.ros.convert import to_quaternion

REST = 1.0  # [s] simulated, within which a robot is at rest after its goal
TICK = 0.1  # [s]
STRAY = 1.5  # [m] from its home, the farthest that a robot may be when an episode begins: no robot meets another one
BEAMS = 360
ANSWER_PATIENCE = 2.0  # [s, wall] for the answer to a tick; a clock that was set back has ticks without one


class SimulatedStage:
    """The simulator: time passes by itself."""

    def __init__(self, system, clients):
        self.system, self.clients = system, clients
        self.now = 0.0  # [s]
        self.homes = {}  # by client: x, y [m] in the world
        rospy.Subscriber("/clock", Clock, self._on_clock)

    def _on_clock(self, message):
        if message._connection_header["callerid"] == "/" + SIMULATOR:  # a fault may publish another clock
            self.now = message.clock.to_sec()

    def prepare(self):
        """Wait for everything to be connected, and for the first odometry."""
        self.wait_for_server()
        for client in self.clients:
            client.wait_for_simulator()
        self.wait_for(lambda: all(client.odom for client in self.clients), "odometry")
        # Not again after the simulator was restarted: the newest position may be from before.
        self.homes = self.homes or {client: (at.x, at.y) for client in self.clients for at in [self.truth_of(client)]}

    def wait_for_server(self):
        """Wait until all servers are connected."""
        for client in self.clients:
            client.wait_for_server()

    def begin_episode(self):
        """Put the robots back where they started, if one of them is far from there."""
        if any(self._distance_from_home(client) > STRAY for client in self.clients):
            self.send_home()

    @contextlib.contextmanager
    def standing_still(self):
        """Meanwhile time is paused, so that nodes which are behind receive all that was sent."""
        self.call("pause")
        try:
            yield
        finally:
            self.call("unpause")

    def send_home(self):
        """Put the robots back where they started."""
        self.reset()
        self.wait_for(lambda: all(map(self._is_home, self.clients)), self._away_from_home)
        self.pass_time(REST)  # a scan from there arrives

    def _away_from_home(self):
        at = {client.namespace: (self.truth_of(client), client.odom.pose.pose.position) for client in self.clients}
        return f"all robots at their spawn poses {list(self.homes.values())}; they are at (in world, odom) {at}"

    def _is_home(self, client):
        odom = client.odom.pose.pose.position
        return self._distance_from_home(client) < STRAY and math.hypot(odom.x, odom.y) < STRAY

    def _distance_from_home(self, client):
        at, (x, y) = self.truth_of(client), self.homes[client]
        return math.hypot(at.x - x, at.y - y)

    def wait_for(self, condition, what, deadline=DEADLINE):
        """The first true value of a condition."""
        return wait_for(condition, what, deadline)

    def pass_wall_time(self, seconds):
        """Let time on the wall pass [s], while simulated time goes on as it can."""
        time.sleep(seconds)

    def pass_time(self, seconds):
        """Let simulated time pass [s]."""
        begin, what = self.now, f"{seconds:g} s of simulated time from {self.now:.2f} s on"
        while self.now < begin + seconds:
            seen = self.now
            wait_for(lambda s=seen: self.now > s, what)  # however slow the machine is, it goes on

    def require_rest(self):
        """Violation unless all robots are at rest one second after the newest result."""
        # Topics do not arrive in step: the clock may be older than the result, and than the motion.
        seen = [client.truth[-1][0] for client in self.clients if client.truth]
        begin = max([self.now, *(client.ended_at for client in self.clients), *seen]) + REST
        for client in self.clients:
            wait_for(lambda c=client: c.truth and c.truth[-1][0] >= begin, f"the robot's motion after {begin:.2f} s")
            client.require_rest_since(begin)

    def require_rest_without_server(self):
        """As require_rest, with a server that has ended: the simulator's command timeout stops its robot."""
        for client in self.clients:  # which may be behind the simulator
            wait_for(client.rests, f"robot {client.namespace!r} at rest without its server")
        self.require_rest()

    def call(self, service, kind=Trigger, *arguments):
        """Call a service of the simulator that must succeed."""
        answer = self.try_to_call(service, kind, *arguments)
        if not answer.success:
            raise Violation(f"{service}{arguments}: {answer.message}")
        return answer

    def try_to_call(self, service, kind=Trigger, *arguments):
        """Call a service of the simulator; its answer, whatever it is."""
        return rospy.ServiceProxy(f"/{SIMULATOR}/{service}", kind)(*arguments)

    def truth_of(self, client):
        """Position of a robot in the world [m]."""
        wait_for(lambda: client.position is not None, "ground truth")
        return client.position

    def reset(self):
        """Robots to their spawn."""
        self.call("reset", Reset, 0)

    def step(self, seconds):
        """Run for a while and stay paused."""
        self.call("step", Step, seconds)

    def set_pose(self, robot, x, y):
        """Request that a robot be placed in the world; whether it was."""
        request = SetPose._request_class(robot=robot)
        request.pose.header.frame_id = "world"
        request.pose.pose.position.x, request.pose.pose.position.y = x, y
        request.pose.pose.orientation.w = 1.0
        return rospy.ServiceProxy(f"/{SIMULATOR}/set_pose", SetPose)(request).success


class MessageStage:
    """A robot made of messages: each of its messages, and its clock, can be wrong in any way.

    Time passes only in `tick`, which waits until the server has answered it.
    """

    def __init__(self, system, clients):
        (self.client,) = clients
        self.system, self.clients = system, clients
        self.now_ns = 0
        self.pose, self.twist = Pose2D(), Twist2D()
        self.answered_ns = -1
        self._ended = {}  # connections of servers that have ended, by the identities of their headers
        self.change_odom = self.change_scan = lambda message: message  # returns a message, or None for none
        self._clock = publisher("/clock", Clock)
        self._odom = publisher("/odom", Odometry)
        self._scan = publisher("/scan", LaserScan)
        rospy.Subscriber("/tick_answer", TickAnswer, self._on_answer)

    def _on_answer(self, message):
        if message.has_command:
            self.twist = Twist2D(message.command.linear.x, message.command.angular.z)
        self.answered_ns = message.tick.to_nsec()

    @property
    def now(self):
        """Simulated time [s]."""
        return self.now_ns / 1e9

    @property
    def stamp(self):
        """Simulated time."""
        return rospy.Time(self.now_ns // 10**9, self.now_ns % 10**9)

    def prepare(self):
        """Wait for everything to be connected, then let a second pass."""
        self.wait_for_server()
        for _ in range(10):
            self.tick()
        wait_for(lambda: self.client.odom, "odometry")

    def wait_for_server(self):
        """Wait until the server and this stage are connected."""
        server = self.client.server
        for topic in (self._clock, self._odom, self._scan):
            wait_for(lambda topic=topic: is_connected(topic, server), f"{server} subscribes to {topic.name}")
        self.client.wait_for_server()
        wanted = {"/tick_answer", "/cmd_vel"}
        wait_for(lambda: wanted <= connections_from(self.system, server), f"{server} sends its commands")

    def standing_still(self):
        """Here time passes only in `tick`."""
        return contextlib.nullcontext()

    def begin_episode(self):
        """Nothing is in this robot's way, wherever it is."""

    def tick(self, length=TICK):
        """One control period, or a longer one [s].

        Moves, publishes odometry and scan, lets the clock reach the tick, and waits for the answer.
        """
        (x, y, yaw), half = self.pose, self.twist.w * length / 2.0
        chord = self.twist.v * length * (math.sin(half) / half if half else 1.0)
        x, y = x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half)
        self.pose = Pose2D(x, y, wrap_angle(yaw + 2.0 * half))
        self.now_ns += round(length / TICK) * 10**8
        for topic, message in (
            (self._odom, self.change_odom(self._odometry())),
            (self._scan, self.change_scan(self._ranges())),
        ):
            if message is not None:
                topic.publish(message)
        self._clock.publish(Clock(self.stamp))
        try:
            wait_for(lambda: self.answered_ns == self.now_ns, "an answer", ANSWER_PATIENCE)
        except Violation:
            self.twist = Twist2D()  # as the simulator's command timeout
        twist = self.twist
        self.client.truth.append((self.now, twist.v, twist.w))

    def set_time(self, seconds):
        """Set the clock, forwards or backwards, without any other message."""
        self.now_ns = round(max(0.0, seconds) * 10) * 10**8
        self.client.restart_time()
        self._clock.publish(Clock(self.stamp))

    def _odometry(self):
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = self.stamp, "odom", "base_footprint"
        message.pose.pose.position.x, message.pose.pose.position.y = self.pose.x, self.pose.y
        message.pose.pose.orientation = to_quaternion(self.pose.yaw)
        return message

    def _ranges(self):
        increment = 2.0 * math.pi / BEAMS
        message = LaserScan(
            angle_max=increment * (BEAMS - 1), angle_increment=increment, range_min=0.12, range_max=10.0
        )
        message.ranges = [math.inf] * BEAMS
        message.header.stamp, message.header.frame_id = self.stamp, "base_scan"
        return message

    def wait_for(self, condition, what, deadline=DEADLINE):
        """Tick until a condition holds; its value."""

        def ticked():
            value = condition()
            if not value:
                self.tick()
            return value

        return wait_for(ticked, what, deadline)

    def pass_wall_time(self, seconds):
        """Tick until so much time on the wall has passed [s]."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self.tick()

    def pass_time(self, seconds):
        """Let simulated time pass [s]."""
        for _ in range(round(seconds / TICK)):
            self.tick()

    def require_rest(self):
        """Violation unless the robot is at rest one second from now."""
        begin = self.now + REST
        self.pass_time(REST + TICK)
        self.client.require_rest_since(begin)
        # It comes by another connection than the answers, by which the robot moves.
        wait_for(lambda: self._last_command() == Twist(), "a last command that stops the robot")

    def _last_command(self):
        """Of a server that has not ended; a stop if there is none."""
        living = [one for one in list(self.client.commands) if id(one._connection_header) not in self._ended]
        return living[-1] if living else Twist()

    def require_rest_without_server(self):
        """A robot of messages is stopped here, as by a command timeout."""
        self.twist = Twist2D()
        headers = [message._connection_header for message in list(self.client.commands)]
        self._ended.update((id(header), header) for header in headers)
