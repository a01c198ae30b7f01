"""Packed messages have, byte for byte, the form in which ROS sends ordinary messages."""

import struct
from io import BytesIO

import numpy as np
from genpy import Message, Time
from geometry_msgs.msg import TransformStamped
from hypothesis import given
from hypothesis import strategies as st
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.component_params import ImuNoise
from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.robot.model import RobotState
from aro_robocop_goto_as.ros import convert, packed
from aro_robocop_goto_as.sensors.imu import ImuSample
from aro_robocop_goto_as.sensors.scan_profiles import PROFILES

NUMBER = st.floats(-1e6, 1e6)
POSE = st.builds(Pose2D, NUMBER, NUMBER, st.floats(-3.0, 3.0))
TWIST = st.builds(Twist2D, NUMBER, NUMBER)
PAIR = st.tuples(NUMBER, NUMBER)
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER).map(np.array)
STAMP = st.tuples(st.integers(0, 2**31), st.integers(0, 999999999))
NAME = st.sampled_from(["odom", "robot_1/base_footprint", "ö"])


def sent(message: Message, seq: int = 1) -> bytes:
    """What rospy would write for a message."""
    if message._has_header:
        message.header.seq = seq
    body = BytesIO()
    message.serialize(body)
    return struct.pack("<I", len(body.getvalue())) + body.getvalue()


@given(STAMP)
def test_clock(stamp: "tuple[int, int]") -> None:
    assert packed.PackedClock().update(stamp).data == sent(Clock(Time(*stamp)))


@given(st.sampled_from(sorted(PROFILES)), NAME, STAMP, st.integers(2, 400), st.randoms(use_true_random=False))
def test_scan(profile: str, frame: str, stamp: "tuple[int, int]", beams: int, random: "object") -> None:
    spec = PROFILES[profile].spec.with_samples(beams)
    ranges = np.array([random.choice([0.0, np.inf, -np.inf, random.uniform(0.1, 30.0)]) for _ in range(beams)])  # type: ignore[attr-defined]
    message = packed.PackedScan(spec, frame).update(ranges, stamp)
    assert message.data == sent(convert.to_scan(ranges, spec, Time(*stamp), frame))


@given(NAME, NAME, st.lists(st.tuples(POSE, TWIST, STAMP), min_size=1, max_size=3))
def test_odometry_counts_its_messages(frame: str, child: str, updates: "list[tuple[Pose2D, Twist2D, object]]") -> None:
    covariance = [float(i) for i in range(36)]
    message = packed.PackedOdometry(frame, child, covariance)
    for seq, (pose, twist, stamp) in enumerate(updates, 1):
        ordinary = convert.to_odometry(pose, twist, Time(*stamp), frame, child, covariance)  # type: ignore[misc]
        assert message.update(pose, twist, stamp).data == sent(ordinary, seq)  # type: ignore[arg-type]


@given(PAIR, PAIR, STAMP)
def test_joint_states(angles: "tuple[float, float]", speeds: "tuple[float, float]", stamp: "tuple[int, int]") -> None:
    state = RobotState(Pose2D(), Twist2D(), angles, speeds)
    expected = sent(convert.to_joint_state(angles, speeds, Time(*stamp)))
    assert packed.PackedJointState().update(state, stamp).data == expected


@given(NAME, VECTOR, VECTOR, STAMP)
def test_imu(frame: str, rates: np.ndarray, accelerations: np.ndarray, stamp: "tuple[int, int]") -> None:
    covariances = convert.imu_covariances(ImuNoise(0.1, 0.2), real=False)
    sample = ImuSample((0.1, 0.2, 0.3, 0.9), rates, accelerations)
    expected = sent(convert.to_imu(sample, Time(*stamp), frame, covariances))
    assert packed.PackedImu(frame, covariances).update(sample, stamp).data == expected


@given(st.lists(st.tuples(NAME, NAME, POSE), min_size=1, max_size=4), STAMP)
def test_transforms(entries: "list[tuple[str, str, Pose2D]]", stamp: "tuple[int, int]") -> None:
    transforms: list[TransformStamped] = [convert.to_transform(*entry, Time(*stamp)) for entry in entries]
    message = packed.PackedTransforms([(parent, child) for parent, child, _ in entries])
    assert message.update([pose for _, _, pose in entries], stamp).data == sent(TFMessage(transforms))
