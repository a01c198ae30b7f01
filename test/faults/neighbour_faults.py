"""Faults of the neighbours: other publishers of commands, clock and tf, idle subscribers, garbage, clicks."""

import contextlib
import math
import socket
import struct
import urllib.parse

import rospy
from faults import ANY, DONE, STOPPED, drive, fault
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from rosgraph_msgs.msg import Clock
from stage import TICK
from system import BRIDGE, Violation, is_connected, publisher, topics_received, wait_for
from tf2_msgs.msg import TFMessage


@fault("surroundings")
def second_publisher(e):
    """Somebody else publishes velocity commands during a goal, also impossible ones."""
    prefix = f"/{e.client.namespace}" if e.client.namespace else ""
    with _other_publisher(e, f"{prefix}/cmd_vel", Twist) as topic:
        wait_for(lambda: is_connected(topic, rospy.get_name()), "the client receives the other commands, too")
        drive(e)
        twist = Twist()
        for _ in range(20):
            twist.linear.x, twist.angular.z = e.rng.choice((0.1, -0.1, 5.0, math.nan)), e.rng.choice((0.0, 1.0, 1e300))
            topic.publish(twist)
            e.stage.pass_time(TICK)
        topic.publish(Twist())
        e.stage.wait_for(lambda: e.client.last_command_of(rospy.get_name()) == Twist(), "the last of these commands")
    return ANY


@contextlib.contextmanager
def _other_publisher(e, name, kind):
    """One more publisher of a topic; at the end, all nodes have received what it has sent."""
    topic = publisher(name, kind)
    try:
        yield topic
    finally:
        topic.unregister()
    for node in [process for process in e.system.processes if process.startswith("/")]:
        wait_for(
            lambda node=node: name not in topics_received(e.system, node), f"{node} receives nothing more on {name}"
        )


@fault("surroundings", costly=True)
def subscribers_that_never_read(e):
    """Three subscribers of everything that never read."""
    with contextlib.ExitStack() as links:
        for node in [name for name in e.system.processes if name.startswith("/")]:
            for topic, kind in _published_by(e.system, node):
                for number in range(3):
                    links.enter_context(_never_reading(e.system, node, topic, kind, f"/never_reads_{number}"))
        drive(e)
        e.stage.pass_time(200.0)  # which fills the buffers to them, at some megabytes
        e.stage.wait_for(e.client.all_ended, "the goal's end beside subscribers that do not read")
    return DONE


def _published_by(system, node):
    """Topics of a node, with their types."""
    types = dict(system.master.getTopicTypes())
    return [(topic, types[topic]) for topic, nodes in system.master.getSystemState()[0] if node in nodes]


def _never_reading(system, node, topic, kind, name):
    """A connection that has subscribed to a topic, and reads nothing."""
    _, _, (_, host, port) = system.api(node).requestTopic(name, topic, [["TCPROS"]])
    link = socket.socket()
    link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    link.connect((host, port))
    fields = [
        f"{key}={value}" for key, value in (("callerid", name), ("topic", topic), ("type", kind), ("md5sum", "*"))
    ]
    header = b"".join(struct.pack("<I", len(field)) + field.encode() for field in fields)
    link.sendall(struct.pack("<I", len(header)) + header)
    return link


@fault("surroundings")
def use_sim_time_changed(e):
    """/use_sim_time is changed, deleted or nonsense during a goal."""
    drive(e)
    master, value = e.system.master, e.rng.choice((False, "no", 0, None))
    if value is None:
        master.deleteParam("/use_sim_time")
    else:
        master.setParam("/use_sim_time", value)
    e.stage.wait_for(e.client.all_ended, "the goal's end with another /use_sim_time")
    master.setParam("/use_sim_time", True)
    return DONE


@fault("clock", needs="simulator", costly=True)
def clock_of_another(e):
    """Another node publishes a clock, 10 s behind, an hour ahead, or both."""
    with _other_publisher(e, "/clock", Clock) as topic:
        for client in e.clients:
            wait_for(lambda c=client: is_connected(topic, c.server), "the server receives the other clock, too")
        drive(e)
        for _ in range(e.rng.randint(1, 10)):
            offset = e.rng.choice((-10.0, 3600.0))
            topic.publish(Clock(rospy.Time.from_sec(max(0.0, e.stage.now + offset))))
            e.stage.pass_time(TICK)
        e.stage.wait_for(e.client.all_ended, "the goal's end beside another clock")
    for client in e.clients:
        client.ended_at = 0.0  # by the other clock, perhaps
    return ANY


@fault("surroundings", needs="bridge")
def tf_contradicting(e):
    """Other nodes publish transforms that contradict, loop, are impossible or an hour ahead; then comes a click."""
    with _other_publisher(e, "/tf", TFMessage) as topic:
        wait_for(lambda: is_connected(topic, f"/{BRIDGE}"), "the bridge receives the transforms")
        drive(e)
        for _ in range(20):
            topic.publish(TFMessage([_contradiction(e) for _ in range(e.rng.randint(1, 3))]))
            e.stage.pass_time(TICK)
    e.stage.wait_for(e.client.all_ended, "the goal's end beside transforms that contradict")
    e.stage.pass_time(1.0)
    with e.stage.standing_still():
        odom = e.client.odom
        pose = odom.pose.pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        ahead = e.rng.uniform(0.2, 0.4)
        goal = _click(e, "base_footprint", ahead, 0.0, odom.header.stamp)
    expected = pose.position.x + ahead * math.cos(yaw), pose.position.y + ahead * math.sin(yaw)
    made = e.client.clicked[goal].position
    if math.hypot(made.x - expected[0], made.y - expected[1]) > 0.05:
        raise Violation(f"a click {ahead:.3f} m ahead became the goal {made}; expected {expected}")
    return DONE


def _contradiction(e):
    """A transform that is wrong in one of the ways that occur."""
    made = TransformStamped()
    frames = ("map", "odom", "base_footprint", "base_scan")
    made.header.frame_id, made.child_frame_id = e.rng.sample(frames, 2)
    made.header.stamp = rospy.Time.from_sec(max(0.0, e.stage.now + e.rng.choice((0.0, 0.0, -5.0, 0.5, 3600.0, 4e9))))
    made.transform.translation.x = e.rng.choice((1.0, -3.0, math.nan, 1e300))
    made.transform.rotation.w = e.rng.choice((1.0, 1.0, 0.0))
    return made


@fault("surroundings", costly=True)
def garbage_on_ports(e):
    """A hundred connections with garbage to the ports of a node."""
    goal = drive(e)
    node = e.rng.choice([name for name in e.system.processes if name.startswith("/")])
    address = urllib.parse.urlparse(e.system.master.lookupNode(node))
    for number in range(100):
        with contextlib.suppress(OSError), socket.create_connection((address.hostname, address.port), 5.0) as link:
            link.sendall(bytes(e.rng.randrange(256) for _ in range(number)))
    with contextlib.suppress(Exception):
        _, _, (protocol, host, port) = e.system.api(node).requestTopic("/garbage", "/rosout", [["TCPROS"]])
        for number in range(100):
            with contextlib.suppress(OSError), socket.create_connection((host, port), 5.0) as link:
                link.sendall(bytes(e.rng.randrange(256) for _ in range(number)))
    e.client.cancel(goal)
    return STOPPED


@fault("surroundings", needs="bridge")
def clicks_without_transform(e):
    """Clicks in RViz in a frame without a transform, without a frame and impossible ones."""
    wait_for(lambda: is_connected(e.client.click_topic, f"/{BRIDGE}"), "the bridge listens")
    for frame, x in (("nowhere", 0.1), ("odom", math.nan), ("a b/", 1e300)):
        e.client.click_topic.publish(_clicked_pose(frame, x, 0.0))
    _click(e, "odom", *e.client.place_near(e.rng))
    return DONE


def _click(e, frame, x, y, stamp=None):
    """A click of which the bridge makes a goal: the goal's id."""
    known = set(e.client.clicked)
    wait_for(lambda: is_connected(e.client.click_topic, f"/{BRIDGE}"), "the bridge listens")
    e.client.click_topic.publish(_clicked_pose(frame, x, y, stamp))
    made = e.stage.wait_for(lambda: [goal for goal in list(e.client.clicked) if goal not in known], "the click's goal")
    e.client.expected += made
    e.client.sent += len(made)
    return made[0]


def _clicked_pose(frame, x, y, stamp=None):
    pose = PoseStamped()
    pose.header.frame_id, pose.header.stamp = frame, stamp or rospy.Time()
    pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.w = x, y, 1.0
    return pose
