"""Packed messages, filled by batch.c, have byte for byte the form in which ROS sends ordinary messages."""

import struct
from dataclasses import replace
from io import BytesIO
from types import SimpleNamespace

import numpy as np
import pytest
from genpy import Time
from geometry_msgs.msg import Point, Quaternion, Vector3
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool, Header
from support import driven
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D, compose, yaw_of
from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.sim import sensor_messages as packed
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics, packed_clock
from aro_robocop_goto_as.sensors.bumper import Bumper
from aro_robocop_goto_as.sensors.imu import ImuParams
from aro_robocop_goto_as.sensors.lidar import PROFILES

NUMBER = st.floats(-1e6, 1e6)
POSE = st.builds(Pose2D, NUMBER, NUMBER, st.floats(-3.0, 3.0))
TWIST = st.builds(Twist2D, NUMBER, NUMBER)
PAIR = st.tuples(NUMBER, NUMBER)
STAMP = st.tuples(st.integers(0, 2**31), st.integers(0, 999999999))
NAME = st.sampled_from(["odom", "robot_1/base_footprint", "ö"])


TOPIC = SimpleNamespace(links=(), impl=None)


def filled(message, stamp):
    """The bytes of a message that a batch has filled at a time [s, ns]."""
    Batch([(TOPIC, message)]).send(stamp[0] * 10**9 + stamp[1])
    return message.data.tobytes()


def sent(message, seq=1):
    """What rospy would write for a message."""
    if message._has_header:
        message.header.seq = seq
    body = BytesIO()
    message.serialize(body)
    return struct.pack("<I", len(body.getvalue())) + body.getvalue()


def _body(topics):
    """The message of the first robot's first topic of a sensor."""
    (((_, message), *_), *_) = topics
    return bytes(message.body())


@given(STAMP)
def test_clock(stamp):
    assert filled(packed_clock(), stamp) == sent(Clock(Time(*stamp)))


def test_latched_message_is_the_one_that_was_sent_last():
    clock, latched = packed_clock(), BytesIO()
    filled(clock, (3, 4))
    clock.serialize(latched)
    assert latched.getvalue() == sent(Clock(Time(3, 4)))[4:]


@given(st.sampled_from(sorted(PROFILES)), NAME, STAMP, st.integers(2, 400), st.randoms(use_true_random=False))
def test_scan_has_as_many_intensities_as_ranges_all_zero(profile, frame, stamp, beams, random):
    spec = replace(PROFILES[profile], samples=beams)
    ranges = np.zeros(beams)
    message = packed.packed_scan(spec, frame, ranges)
    ranges[:] = [random.choice([0.0, np.inf, -np.inf, random.uniform(0.1, 30.0)]) for _ in range(beams)]
    figures = (spec.angle_min, spec.angle_max, spec.increment, 0.0, 0.0, spec.range_min, spec.range_max)
    expected = LaserScan(Header(0, Time(*stamp), frame), *figures, ranges.tolist(), [0.0] * beams)
    assert filled(message, stamp) == sent(expected)


@given(NAME, NAME, st.lists(st.tuples(POSE, TWIST, STAMP), min_size=1, max_size=3))
def test_odometry_counts_its_messages(frame, child, updates):
    variances, row, twist_row = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), np.zeros(3), np.zeros(2)
    message = packed.packed_odometry(frame, child, variances, row, twist_row)
    for seq, (pose, twist, stamp) in enumerate(updates, 1):
        row[:], twist_row[:] = pose, twist
        ordinary = Odometry(header=Header(0, Time(*stamp), frame), child_frame_id=child)
        ordinary.pose.pose.position = Point(pose.x, pose.y, 0.0)
        ordinary.pose.pose.orientation = convert.to_quaternion(pose.yaw)
        ordinary.twist.twist = convert.to_twist_msg(twist)
        ordinary.pose.covariance = ordinary.twist.covariance = np.diag(variances).ravel().tolist()
        assert filled(message, stamp) == sent(ordinary, seq)


@given(PAIR, PAIR, STAMP)
def test_joint_states(angles, speeds, stamp):
    expected = sent(convert.to_joint_state(angles, speeds, Time(*stamp)))
    assert filled(packed.packed_joint_state(np.array(angles), np.array(speeds)), stamp) == expected


@given(NAME, st.lists(NUMBER, min_size=10, max_size=10).map(np.array), STAMP, st.booleans())
def test_imu(frame, sample, stamp, real):
    variances = (0.0025, 0.02, 0.04) if real else (1e-6, 0.1**2, 0.2**2)  # those of a TurtleBot3's firmware
    orientation, rates, force = (np.diag([variance] * 3).ravel().tolist() for variance in variances)
    expected = Imu(
        *(Header(0, Time(*stamp), frame), Quaternion(*sample[:4]), orientation),
        *(Vector3(*sample[4:7]), rates, Vector3(*sample[7:]), force),
    )
    assert filled(packed.packed_imu(frame, ImuParams(0.1, 0.2), real, sample), stamp) == sent(expected)


def test_odometry_of_a_real_robot_has_no_covariances_and_its_imu_those_of_the_firmware(simulator):
    topics = StepTopics(simulator(covariances="real")).topics
    odom, imu = Odometry().deserialize(_body(topics["odom"])), Imu().deserialize(_body(topics["imu"]))
    assert (imu.orientation_covariance[0], imu.angular_velocity_covariance[4]) == (0.0025, 0.02)
    assert set(odom.pose.covariance + odom.twist.covariance) == {0.0}


def test_a_sensor_with_a_mount_has_a_frame_of_its_own_on_tf_static(simulator):
    sim = simulator()
    sim.sensors.bumper.frame, sim.sensors.bumper.mounts = "bumper_link", (Pose3D((0.1, 0.0, 0.02)),)
    frames = {(t.header.frame_id, t.child_frame_id): t.transform for t in StepTopics(sim).static_transforms()}
    at = frames["robot_1/base_link", "robot_1/bumper_link"].translation
    assert (at.x, at.y, at.z) == (0.1, 0.0, 0.02)


def test_a_derived_sensor_has_the_message_of_the_sensor_that_it_is_derived_from(simulator):
    class RearBumper(Bumper):
        topic = "rear_bumper"

    sim = simulator()
    (topic,) = packed.topics_of(RearBumper(sim.params.sensors.bumper, sim.context), StepTopics(sim).robots[0], False)
    assert (topic.name, topic.kind) == ("robot_1/rear_bumper", Bool)


def test_what_a_step_publishes_has_the_time_of_this_step_as_its_stamp(simulator):
    sim = simulator()
    topics = StepTopics(sim)
    for stamp_ns in (100_000_000, 200_000_000):
        (*_, due) = driven(sim, Twist2D(0.2, 0.0), 0.1, ["odom"])
        messages = dict((topic.name, message) for topic, message in topics.messages_due(due))
        Batch([], filled=list(messages.values())).send(sim.stamp_ns)
        stamp = Odometry().deserialize(messages["/robot_1/odom"].body()).header.stamp
        assert (stamp.to_nsec(), sim.stamp_ns) == (stamp_ns, stamp_ns)


@given(st.lists(st.tuples(NAME, NAME, POSE), min_size=1, max_size=4), STAMP)
def test_transforms(entries, stamp):
    transforms = [convert.to_transform(*entry, Time(*stamp)) for entry in entries]
    message = packed.packed_transforms([(parent, child, np.array(pose)) for parent, child, pose in entries])
    assert filled(message, stamp) == sent(TFMessage(transforms))


def test_transforms_lead_from_the_map_to_where_the_robot_is_if_localization_is_true(simulator):
    sim = simulator("empty", localization="truth", odom_wheel_radius_error=0.1, drive="kinematic")
    topics = StepTopics(sim)
    message = packed.packed_transforms(topics.transforms(topics.robots[0]))
    driven(sim, Twist2D(0.2, 1.0), 0.9, ["odom"])
    filled(message, (0, 0))
    sent = sorted(TFMessage().deserialize(message.body()).transforms, key=lambda t: t.header.frame_id)
    map_from_odom, odom_from_base = (
        Pose2D(
            t.transform.translation.x, t.transform.translation.y, yaw_of(convert.from_quaternion(t.transform.rotation))
        )
        for t in sent
    )
    assert compose(map_from_odom, odom_from_base) == pytest.approx(sim.world_from_footprint(), abs=1e-6)
    assert map_from_odom.x < -0.001


@pytest.mark.parametrize(
    "odom_tf, localization, children",
    [
        (True, "static", ["base_footprint"]),
        (False, "static", []),
        (True, "truth", ["base_footprint", "odom"]),
    ],
)
def test_transforms_that_another_node_sends_are_left_out(simulator, odom_tf, localization, children):
    sim = simulator(odom_tf=odom_tf, localization=localization)
    topics = StepTopics(sim)
    found = topics.transforms(topics.robots[0])
    assert [child.rpartition("/")[2] for _, child, _ in found] == children
