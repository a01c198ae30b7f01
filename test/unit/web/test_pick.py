"""A click on the page -> a point of the floor."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.web.pick import FARTHEST_CLICK, floor_point


@given(st.floats(-20, 20), st.floats(-20, 20), st.floats(0.1, 20), st.floats(-9, 9), st.floats(-9, 9))
def test_a_click_hits_the_floor_where_the_ray_through_it_does(x, y, height, to_x, to_y) -> None:
    found = floor_point((x, y, height), (to_x - x, to_y - y, -height))
    assert found == pytest.approx((to_x, to_y), abs=1e-9)


@pytest.mark.parametrize(
    "origin, direction",
    [
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.1)),
        ((0.0, 0.0, 1.0), (1.0, 0.0, -1e-6)),
        ((0.0, 0.0, 1.0), (math.nan, 0.0, -1.0)),
        ((0.0, 0.0, math.inf), (0.0, 0.0, -1.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
    ],
)
def test_a_click_into_the_sky_or_beyond_the_horizon_hits_nothing(origin, direction) -> None:
    assert floor_point(origin, direction) is None


@pytest.mark.parametrize("share, hits", [(0.99, True), (1.01, False)])
def test_a_click_hits_the_floor_up_to_a_limited_distance(share, hits) -> None:
    assert (floor_point((0.0, 0.0, 1.0), (share * FARTHEST_CLICK, 0.0, -1.0)) is not None) == hits
