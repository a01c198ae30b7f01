"""Where the cameras are at first, and which point of the floor a click hits."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.web.page import CAMERA, FARTHEST_CLICK, FIELD, LOOK_AT, fit_view, floor_point

CORNERS = [(x, y, 0.0) for x in (-2.5, 2.5) for y in (-2.5, 2.5)]  # [m] of a room of 5 x 5 m
FREE = 0.55  # of a phone's height, above the panel


def seen(camera: SimpleNamespace, point: np.ndarray) -> np.ndarray:
    """Where a point appears: from the left and from the top, as shares of the view's height."""
    ahead = np.subtract(camera.look_at, camera.position)
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    away = np.subtract(point, camera.position)
    scale = 0.5 / math.tan(FIELD / 2.0) / (away @ ahead)
    return np.array((camera.aspect / 2.0 + scale * (away @ right), 0.5 - scale * (away @ np.cross(right, ahead))))


def opened(width: int, height: int) -> SimpleNamespace:
    camera = SimpleNamespace(position=CAMERA, look_at=LOOK_AT, image_width=width, aspect=width / height)
    fit_view(SimpleNamespace(camera=camera))
    return camera


@pytest.mark.parametrize("width, height", [(390, 844), (360, 640), (430, 932)])
def test_a_phone_shows_the_whole_room_above_the_panel(width: int, height: int) -> None:
    camera = opened(width, height)
    for corner in CORNERS:
        column, row = seen(camera, np.array(corner))
        assert 0.0 < column < camera.aspect and 0.0 < row < FREE, corner


def test_a_window_of_a_desk_has_the_first_view() -> None:
    camera = opened(1300, 800)
    assert (camera.position, camera.look_at) == (CAMERA, LOOK_AT)


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
