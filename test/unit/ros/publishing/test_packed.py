"""Packed messages, filled by batch.c, have byte for byte the form in which ROS sends ordinary messages."""

import struct
from io import BytesIO
from types import SimpleNamespace
from typing import Any

import numpy as np
from genpy import Message, Time
from geometry_msgs.msg import TransformStamped
from hypothesis import given
from hypothesis import strategies as st
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.covariances import imu_covariances
from aro_robocop_goto_as.ros.publishing import packed
from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.sensors.imu import ImuParams
from aro_robocop_goto_as.sensors.scan_profiles import PROFILES

NUMBER = st.floats(-1e6, 1e6)
POSE = st.builds(Pose2D, NUMBER, NUMBER, st.floats(-3.0, 3.0))
TWIST = st.builds(Twist2D, NUMBER, NUMBER)
PAIR = st.tuples(NUMBER, NUMBER)
STAMP = st.tuples(st.integers(0, 2**31), st.integers(0, 999999999))
NAME = st.sampled_from(["odom", "robot_1/base_footprint", "ö"])


TOPIC: Any = SimpleNamespace(links=(), impl=None)


def filled(message: packed.PackedMessage, stamp: "tuple[int, int]") -> bytes:
    """The bytes of a message that a batch has filled at a time [s, ns]."""
    Batch([(TOPIC, message)]).send(stamp[0] * 10**9 + stamp[1])
    return message.data.tobytes()


def sent(message: Message, seq: int = 1) -> bytes:
    """What rospy would write for a message."""
    if message._has_header:
        message.header.seq = seq
    body = BytesIO()
    message.serialize(body)
    return struct.pack("<I", len(body.getvalue())) + body.getvalue()


@given(STAMP)
def test_clock(stamp: "tuple[int, int]") -> None:
    assert filled(packed.packed_clock(), stamp) == sent(Clock(Time(*stamp)))


def test_latched_message_is_the_one_that_was_sent_last() -> None:
    clock, latched = packed.packed_clock(), BytesIO()
    filled(clock, (3, 4))
    clock.serialize(latched)
    assert latched.getvalue() == sent(Clock(Time(3, 4)))[4:]


@given(st.sampled_from(sorted(PROFILES)), NAME, STAMP, st.integers(2, 400), st.randoms(use_true_random=False))
def test_scan(profile: str, frame: str, stamp: "tuple[int, int]", beams: int, random: "object") -> None:
    spec = PROFILES[profile].spec.with_samples(beams)
    ranges = np.zeros(beams)
    message = packed.packed_scan(spec, frame, ranges, packed.counter())
    ranges[:] = [random.choice([0.0, np.inf, -np.inf, random.uniform(0.1, 30.0)]) for _ in range(beams)]  # type: ignore[attr-defined]
    assert filled(message, stamp) == sent(convert.to_scan(ranges, spec, Time(*stamp), frame))


@given(NAME, NAME, st.lists(st.tuples(POSE, TWIST, STAMP), min_size=1, max_size=3))
def test_odometry_counts_its_messages(frame: str, child: str, updates: "list[tuple[Pose2D, Twist2D, object]]") -> None:
    covariance, row, twist_row = [float(i) for i in range(36)], np.zeros(3), np.zeros(2)
    message = packed.packed_odometry(frame, child, covariance, row, twist_row)
    for seq, (pose, twist, stamp) in enumerate(updates, 1):
        row[:], twist_row[:] = pose, twist
        ordinary = convert.to_odometry(pose, twist, Time(*stamp), frame, child, covariance)  # type: ignore[misc]
        assert filled(message, stamp) == sent(ordinary, seq)  # type: ignore[arg-type]


@given(PAIR, PAIR, STAMP)
def test_joint_states(angles: "tuple[float, float]", speeds: "tuple[float, float]", stamp: "tuple[int, int]") -> None:
    expected = sent(convert.to_joint_state(angles, speeds, Time(*stamp)))
    assert filled(packed.packed_joint_state(np.array(angles), np.array(speeds)), stamp) == expected


@given(NAME, st.lists(NUMBER, min_size=10, max_size=10).map(np.array), STAMP)
def test_imu(frame: str, sample: np.ndarray, stamp: "tuple[int, int]") -> None:
    covariances = imu_covariances(ImuParams(0.1, 0.2), real=False)
    expected = sent(convert.to_imu(sample, Time(*stamp), frame, covariances))
    assert filled(packed.packed_imu(frame, covariances, sample), stamp) == expected


@given(st.lists(st.tuples(NAME, NAME, POSE), min_size=1, max_size=4), STAMP)
def test_transforms(entries: "list[tuple[str, str, Pose2D]]", stamp: "tuple[int, int]") -> None:
    transforms: list[TransformStamped] = [convert.to_transform(*entry, Time(*stamp)) for entry in entries]
    message = packed.packed_transforms([(parent, child, np.array(pose)) for parent, child, pose in entries])
    assert filled(message, stamp) == sent(TFMessage(transforms))
