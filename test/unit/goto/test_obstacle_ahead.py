"""The clearance ahead as a pure function of a scan."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import wrap_angle
from aro_robocop_goto_as.goto.obstacle_ahead import clearance_ahead

LAYOUTS = [
    (0.0, 6.28319 / 359, 360),
    (-math.pi, 2 * math.pi / 360, 360),
    (math.pi, -2 * math.pi / 500, 500),
    (-2.0, 0.01, 401),
]


def _ahead(ranges, layout=LAYOUTS[0]):
    return clearance_ahead(ranges, layout[0], layout[1], 0.12, 10.0, math.pi / 6)


@given(st.sampled_from(LAYOUTS), st.floats(-math.pi, math.pi), st.floats(0.13, 9.9))
def test_only_returns_within_30_degrees_of_ahead_count(layout, direction, distance):
    start, increment, count = layout
    angles = np.array([wrap_angle(start + increment * i) for i in range(count)])
    beam = int(np.argmin(np.abs(angles - direction)))
    ranges = [math.inf] * count
    ranges[beam] = distance
    expected = distance if abs(angles[beam]) <= math.pi / 6 + 1e-9 else math.inf
    assert _ahead(ranges, layout) == expected


@pytest.mark.parametrize(
    "ranges, expected",
    [
        *(([nothing] * 360, math.inf) for nothing in (math.inf, 0.0, 0.12, 10.0, 55.0)),
        ([5.0] * 5 + [0.7] + [6.0] * 354, 0.7),
        ([-math.inf] + [5.0] * 359, 0.0),
    ],
)
def test_the_nearest_valid_return_counts_and_what_is_too_near_is_at_zero(ranges, expected):
    assert _ahead(ranges) == expected


@pytest.mark.parametrize("valid", [math.inf, 0.0, 55.0])
def test_a_scan_of_nan_ahead_is_invalid_but_one_valid_beam_is_enough(valid):
    ranges = [math.nan if abs(beam - 180) > 140 else 2.0 for beam in range(360)]  # NaN within 40 degrees of ahead
    assert math.isnan(_ahead(ranges) or 0.0)
    ranges[350] = valid
    assert _ahead(ranges) == math.inf
    ranges[5] = 0.7
    assert _ahead(ranges) == 0.7


@pytest.mark.parametrize("limits", [(math.nan, 10.0), (0.12, math.nan), (0.0, 0.0), (10.0, 0.12), (0.0, -math.inf)])
def test_a_scan_whose_range_limits_are_nan_or_leave_no_range_is_invalid(limits):
    assert math.isnan(clearance_ahead([0.5] * 360, *LAYOUTS[0][:2], *limits, math.pi / 6) or 0.0)


@pytest.mark.parametrize(
    "layout",
    [
        *((math.nan, 0.1, 10), (0.0, math.nan, 10), (math.inf, 0.1, 10), (0.0, math.inf, 10)),  # no directions
        *((0.0, increment, 360) for increment in (0.0, -0.0, 1.0, -1e30)),  # one direction, or round and round
        *((0.0, math.radians(turn) / 358, 360) for turn in (540.0, -540.0)),
        *((1.0, 0.1, 10), (0.0, 0.1, 0)),  # not ahead, no beam
    ],
)
def test_scan_whose_beams_do_not_point_ahead_or_can_not_be_told_says_nothing(layout):
    assert _ahead([0.5] * layout[2], layout) is None


def test_a_single_beam_needs_no_increment_and_one_and_a_half_turns_are_allowed():
    assert clearance_ahead([0.5], 0.0, 0.0, 0.12, 10.0, math.pi / 6) == 0.5
    assert clearance_ahead([0.5] * 360, 0.0, math.radians(539.0) / 359, 0.12, 10.0, math.pi / 6) == 0.5
