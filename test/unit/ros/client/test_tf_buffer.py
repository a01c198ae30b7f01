"""A TF buffer in which the right transforms stay in force, whatever other nodes send."""

import math
from typing import Callable, Iterator, List, Optional, Tuple

import pytest
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

from aro_robocop_goto_as.ros.client.tf_buffer import MEMORY, TfBuffer

NOW = 100.0  # [s]
Warnings = List[str]


@pytest.fixture(name="warnings")
def _warnings(monkeypatch: pytest.MonkeyPatch) -> Iterator[Warnings]:
    """What is logged, without the limit to one line in ten seconds."""
    logged: Warnings = []
    monkeypatch.setattr(rospy, "logwarn_throttle", lambda period, text: logged.append(text))
    yield logged


def _buffer(now: float = NOW) -> TfBuffer:
    return TfBuffer(debug=False, clock=lambda: rospy.Time.from_sec(now))


def _transform(
    x: float = 1.0, stamp: float = NOW, frames: Tuple[str, str] = ("odom", "base"), w: float = 1.0
) -> TransformStamped:
    made = TransformStamped()
    made.header.frame_id, made.child_frame_id = frames
    made.header.stamp = rospy.Time.from_sec(stamp)
    made.transform.translation.x, made.transform.rotation.w = x, w
    return made


def _x(buffer: TfBuffer, stamp: float, frames: Tuple[str, str] = ("odom", "base")) -> Optional[float]:
    """The translation between two frames; None if they are not connected then."""
    try:
        return float(buffer.lookup_transform_core(*frames, rospy.Time.from_sec(stamp)).transform.translation.x)
    except tf2_ros.TransformException:
        return None


@pytest.mark.parametrize(
    "intruder, reason",
    [
        (lambda: _transform(9.0, NOW + 3600.0), "stamp of 3700.000 s is more than 600 s ahead of 100.000 s"),
        (lambda: _transform(9.0, NOW + 4e9), "its stamp of 4000000100 s is beyond 2147483648 s"),
        (lambda: _transform(1e300, NOW + 0.5), "expected finite numbers within"),
        (lambda: _transform(math.nan, NOW + 0.5), "expected finite numbers within"),
        (lambda: _transform(-math.inf, NOW + 0.5), "expected finite numbers within"),
        (lambda: _transform(9.0, NOW + 0.5, w=0.0), "expected a quaternion of length 1"),
        (lambda: _transform(9.0, NOW + 0.5, w=math.nan), "expected a quaternion of length 1"),
    ],
    ids=["an hour ahead", "beyond tf2", "too far", "not a number", "infinite", "no rotation", "rotation not a number"],
)
def test_impossible_transform_is_refused_with_its_reason_and_the_publisher_continues(
    warnings: Warnings, intruder: Callable[[], TransformStamped], reason: str
) -> None:
    buffer = _buffer()
    buffer.set_transform(_transform(1.0), "/robot")
    buffer.set_transform(intruder(), "/intruder")
    buffer.set_transform(_transform(2.0, NOW + 1.0), "/robot")
    assert _x(buffer, NOW) == 1.0 and _x(buffer, NOW + 1.0) == 2.0 and _x(buffer, 0.0) == 2.0
    (warning,) = warnings
    assert "ignoring transform 'odom' -> 'base' of /intruder: " in warning and reason in warning


@pytest.mark.parametrize("ahead", [0.5, 2.0, MEMORY])
def test_localization_may_date_its_transforms_into_the_future(warnings: Warnings, ahead: float) -> None:
    buffer = _buffer()
    buffer.set_transform(_transform(1.0, NOW + ahead), "/amcl")
    assert _x(buffer, NOW + ahead) == 1.0 and not warnings


def test_transforms_that_arrive_late_are_not_dropped_because_of_newer_ones(warnings: Warnings) -> None:
    buffer = _buffer()
    buffer.set_transform(_transform(9.0, NOW + 90.0, ("map", "base")), "/of_a_publisher_whose_topic_is_faster")
    buffer.set_transform(_transform(1.0), "/robot")
    assert _x(buffer, NOW) == 1.0 and not warnings


def test_stamps_are_not_compared_with_a_clock_that_has_not_arrived(warnings: Warnings) -> None:
    buffer = _buffer(now=0.0)
    buffer.set_transform(_transform(1.0), "/robot")
    assert _x(buffer, NOW) == 1.0 and not warnings


def test_static_transform_stays_where_its_publisher_put_it(warnings: Warnings) -> None:
    buffer = _buffer()
    buffer.set_transform_static(_transform(3.0, frames=("map", "odom")), "/robocop_sim")
    buffer.set_transform(_transform(9.0, frames=("base", "odom")), "/intruder")
    assert _x(buffer, NOW + 5.0, ("map", "odom")) == 3.0
    assert warnings == [
        "ignoring transform 'base' -> 'odom' of /intruder: /robocop_sim says on /tf_static where 'odom' is"
    ]


def test_static_transform_is_replaced_by_another_one_and_by_its_own_publisher(warnings: Warnings) -> None:
    buffer, frames = _buffer(), ("map", "odom")
    buffer.set_transform_static(_transform(3.0, frames=frames), "/robocop_sim")
    buffer.set_transform(_transform(4.0, frames=frames), "/robocop_sim")
    assert _x(buffer, NOW, frames) == 4.0
    buffer.set_transform_static(_transform(5.0, frames=frames), "/another")
    assert _x(buffer, NOW, frames) == 5.0 and not warnings


def test_publisher_corrects_a_contradicting_parent_with_its_next_transform() -> None:
    buffer = _buffer()
    buffer.set_transform(_transform(1.0), "/robot")
    buffer.set_transform(_transform(9.0, NOW + 0.5, ("map", "base")), "/intruder")
    buffer.set_transform(_transform(2.0, NOW + 1.0), "/robot")
    assert _x(buffer, NOW + 1.0) == _x(buffer, 0.0) == 2.0
