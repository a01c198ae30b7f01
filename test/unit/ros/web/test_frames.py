"""Where the page's frames are: what tf2 knows, and what it forgets."""

import pytest
import rospy
from frames_of_tests import transform

from aro_robocop_goto_as.ros.client.goal_frame import MAX_STAMP
from aro_robocop_goto_as.ros.web.frames import MAX_LEAD, Frames


def x_at(frames, stamp=0.0):
    """Where base is in map at a stamp [s], on a way along x; None if that is not known."""
    found = frames.lookup("map", "base", rospy.Time(stamp))
    return None if found is None else found.position[0]


@pytest.fixture
def frames():
    frames = Frames()
    frames.update(transform("map", "odom", 10.0), is_static=True)
    for stamp in (8.0, 9.0):
        frames.update(transform("odom", "/base", stamp, stamp=stamp))
    return frames


def test_a_frame_is_where_it_is_now_or_was_at_a_stamp_and_unknown_at_a_later_one(frames):
    assert [x_at(frames, stamp) for stamp in (0.0, 8.25, 9.5, MAX_STAMP + 1)] == [19.0, 18.25, None, None]
    assert frames.lookup("map", "nowhere") is None
    assert [frames.knows(name) for name in ("map", "base", "nowhere")] == [True, True, False]


def test_a_transform_that_is_much_older_replaces_newer_ones_as_after_a_restart_of_the_simulator(frames):
    frames.update(transform("odom", "base", 7.0, stamp=9.0 - MAX_LEAD + 0.1))
    assert x_at(frames) == 19.0
    frames.update(transform("odom", "base", 1.0, stamp=0.5))
    assert x_at(frames) == 11.0 and x_at(frames, 9.0) is None
