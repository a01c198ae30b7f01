"""Which transform a goal in another frame gets."""

import functools
import math
import re

import pytest
import rospy
import tf2_ros
from geometry_msgs.msg import PoseStamped, TransformStamped

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.ros.client import goal_frame
from aro_robocop_goto_as.ros.client.goal_frame import MAX_STAMP, GoalTransformer


@pytest.fixture
def transformer(monkeypatch):
    """Makes one for goals in odom (default: base), which knows the x [m] of base at these times [s]; its warnings."""
    monkeypatch.setattr(goal_frame.tf2_ros, "Buffer", functools.partial(tf2_ros.Buffer, debug=False))
    monkeypatch.setattr(goal_frame.tf2_ros, "TransformListener", lambda buffer: None)
    warnings = []
    monkeypatch.setattr(rospy, "logwarn", lambda text, *values: warnings.append((text % values).split(" at the ")[0]))

    def make(x_at):
        made = GoalTransformer("odom", "base", 0.01)
        for time, x in x_at.items():
            base = TransformStamped(child_frame_id="base")
            base.header.frame_id, base.header.stamp = "odom", rospy.Time(time)
            base.transform.translation.x, base.transform.rotation.w = x, 1.0
            made.buffer.set_transform(base, "test")
        return made, warnings

    return make


def click(stamp):
    """A click 0.5 m in front of base."""
    pose = PoseStamped()
    pose.header.frame_id, pose.header.stamp, pose.pose.position.x = "base", rospy.Time(stamp), 0.5
    return pose


@pytest.mark.parametrize(
    "x_at, stamp, x, warned",
    [
        ({10: 1.0, 20: 2.0}, 15, 1.5 + 0.5, False),
        ({10: 1.0}, 15, 1.0 + 0.5, True),
        ({10: 1.0}, MAX_STAMP + 1, 1.0 + 0.5, True),
    ],
    ids=["between two", "earlier", "2038"],
)
def test_goal_is_transformed_at_its_stamp_or_else_by_the_newest_pose(transformer, x_at, stamp, x, warned):
    made, warnings = transformer(x_at)
    assert made.resolve(click(stamp)).x == pytest.approx(x)
    assert warnings == ["no transform from 'base' to 'odom'"] * warned


def test_goal_without_a_frame_is_taken_in_the_default_one_with_a_warning(transformer):
    made, warnings = transformer({10: 1.0})
    assert made.resolve(PoseStamped()).x == 1.0
    assert len(warnings) == 1 and warnings[0].startswith("goal without frame_id; assuming the default ")


def test_goal_that_is_no_position_is_refused(transformer):
    pose = click(15)
    pose.pose.position.y = math.nan
    with pytest.raises(FrameError, match="expected finite numbers within"):
        transformer({15: 1.0})[0].resolve(pose)


def test_goal_in_a_frame_that_nothing_connects_is_refused(transformer):
    with pytest.raises(FrameError, match=re.escape("no transform from 'base' to 'odom' within 0.01 s: ")):
        transformer({})[0].resolve(click(15))
