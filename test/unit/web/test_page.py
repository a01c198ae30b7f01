"""Where the cameras are at first, and which point of the floor a click hits."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.web.page import CAMERA, FARTHEST_CLICK, FIELD, LOOK_AT, fit_view, floor_point, show_places

CORNERS = [(x, y, 0.0) for x in (-2.5, 2.5) for y in (-2.5, 2.5)]  # [m] of a room of 5 x 5 m
FREE = 0.55  # of a phone's height, above the panel
PANEL = 0.42  # of a desk's height: the panel's width


def seen(camera: SimpleNamespace, point: np.ndarray) -> np.ndarray:
    """Where a point appears: from the left and from the top, as shares of the view's height."""
    ahead = np.subtract(camera.look_at, camera.position)
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    away = np.subtract(point, camera.position)
    scale = 0.5 / math.tan(FIELD / 2.0) / (away @ ahead)
    return np.array((camera.aspect / 2.0 + scale * (away @ right), 0.5 - scale * (away @ np.cross(right, ahead))))


FIRST = SimpleNamespace(position=np.array(CAMERA), look_at=np.array(LOOK_AT))
PHONE, DESK = (390, 844), (1300, 800)  # [pixel]


def opened(width: int, height: int) -> SimpleNamespace:
    client = SimpleNamespace(camera=SimpleNamespace(image_width=width, aspect=width / height))
    fit_view(client, FIRST)
    return client


@pytest.mark.parametrize("width, height", [PHONE, (360, 640), (430, 932)])
def test_a_phone_shows_the_whole_room_above_the_panel(width: int, height: int) -> None:
    camera = opened(width, height).camera
    for corner in CORNERS:
        column, row = seen(camera, np.array(corner))
        assert 0.0 < column < camera.aspect and 0.0 < row < FREE, corner


def test_a_window_of_a_desk_has_the_first_view() -> None:
    camera = opened(*DESK).camera
    assert (*camera.position, *camera.look_at) == (*CAMERA, *LOOK_AT)


def cameras_after(places) -> list:
    """The first camera, and those of a phone and a desk, which were open before, when these places are shown."""
    clients = [opened(*PHONE), opened(*DESK)]
    server = server_of(clients)
    show_places(server, places)
    return [server.initial_camera, *(client.camera for client in clients)]


def server_of(clients) -> SimpleNamespace:
    first = SimpleNamespace(position=np.array(CAMERA), look_at=np.array(LOOK_AT))
    return SimpleNamespace(initial_camera=first, get_clients=lambda: dict(enumerate(clients)))


def test_a_view_that_somebody_has_chosen_stays_when_the_same_world_is_drawn_anew() -> None:
    client = opened(*DESK)
    server, places = server_of([client]), [(8.0, 0.0, 0.0)]
    show_places(server, places)
    client.camera.position = (1.0, 2.0, 3.0)
    show_places(server, places)
    assert client.camera.position == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("places", [[], CORNERS, [(1.9, 0.0, 0.2)], [(-2.5, -2.5, 0.0), (0.5, 2.5, 0.0)]])
def test_a_room_that_is_not_larger_than_usual_is_shown_in_the_usual_size(places) -> None:
    first, _, desk = cameras_after(places)
    away = np.subtract(CAMERA, LOOK_AT)
    assert first.position - first.look_at == pytest.approx(away) == desk.position - desk.look_at
    assert places != CORNERS or (*first.position, *first.look_at) == (*CAMERA, *LOOK_AT)


@pytest.mark.parametrize("low, high", [((-0.6, -0.6), (7.0, 5.4)), ((-9.0, 3.0), (-2.0, 9.0))])
def test_all_cameras_show_a_larger_world_and_the_origin(low, high) -> None:
    _, phone, desk = cameras_after([(*low, 0.0), (*high, 0.0)])
    for corner in [(x, y, 0.0) for x in (low[0], high[0], 0.0) for y in (low[1], high[1], 0.0)]:
        column, row = seen(phone, np.array(corner))
        assert 0.0 < column < phone.aspect and 0.0 < row < FREE, corner
        column, row = seen(desk, np.array(corner))
        assert 0.0 < column < desk.aspect - PANEL and 0.0 < row < 1.0, corner


def test_what_is_very_far_away_does_not_make_the_robot_invisible() -> None:
    _, _, near = cameras_after([(10.0, 0.0, 0.0)])
    _, _, far = cameras_after([(500.0, 0.0, 0.0)])
    assert near.position == pytest.approx(far.position)


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
