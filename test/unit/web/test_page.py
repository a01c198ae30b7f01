"""Where the cameras are at first, and which point of the floor a click hits."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.web.page import (
    FIELD,
    FILLED,
    HEIGHT,
    LOWEST,
    MAX_CLICK,
    RIGHT,
    BrowserCameras,
    axes_of,
    floor_point,
)

SCENES = [(393, 400), (1081, 1099), (250, 900), (457, 293), (955, 800), (580, 620), (1585, 1000)]  # [pixel]


def room(low=(-2.5, -2.5), high=(2.5, 2.5)):
    return np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (0.0, HEIGHT)])


def server_of(*sizes):
    clients = [
        SimpleNamespace(camera=SimpleNamespace(image_width=width, image_height=height, on_update=lambda _: None))
        for width, height in sizes
    ]
    connected = []
    server = SimpleNamespace(initial_camera=SimpleNamespace(), get_clients=lambda: dict(enumerate(clients)))
    server.on_client_connect = connected.append
    server.cameras = BrowserCameras(server)
    for client in clients:
        connected[0](client)
    return server


def seen(camera, points):
    """Where points (n, 3) [m] appear: (n, 2) [pixel] from the left and from the top."""
    scale, (ahead, up) = (
        camera.image_height / 2.0 / math.tan(FIELD / 2.0),
        axes_of(camera.image_width / camera.image_height),
    )
    away = points - camera.position
    offset = np.stack([away @ RIGHT, -(away @ up)], axis=1) / (away @ ahead)[:, None]
    return np.array((camera.image_width, camera.image_height)) / 2.0 + scale * offset


def expect_filled_from_the_middle(camera, corners):
    size = np.array((camera.image_width, camera.image_height))
    low, high = seen(camera, corners).min(axis=0), seen(camera, corners).max(axis=0)
    assert (low + high) / 2.0 == pytest.approx(size / 2.0, abs=0.05 * camera.image_height)
    assert max((high - low) / size) == pytest.approx(FILLED)


@pytest.mark.parametrize("size", SCENES)
@pytest.mark.parametrize(
    "places, corners",
    [
        ([], room()),
        ([(1.8, 0.0, 0.2)], room((-1.6, -2.5), (3.4, 2.5))),
        ([(-0.6, -0.6, 0.0), (7.0, 5.4, 0.0)], room((-0.6, -0.6), (7.0, 5.4))),
        ([(-9.0, 3.0, 0.0), (-2.0, 9.0, 0.0)], room((-9.0, 0.0), (0.0, 9.0))),
    ],
)
def test_a_room_around_the_origin_or_a_larger_world_fills_the_scene(size, places, corners):
    server = server_of(size)
    server.cameras.show(places)
    expect_filled_from_the_middle(server.get_clients()[0].camera, corners)


def test_a_view_that_somebody_has_chosen_stays_when_the_same_world_is_drawn_anew():
    server, places = server_of((1300, 800)), [(8.0, 0.0, 0.0)]
    server.cameras.show(places)
    camera = server.get_clients()[0].camera
    camera.position = chosen = (1.0, 2.0, 3.0)
    server.cameras.show(places)
    assert camera.position == chosen


def camera_that_reports(width=390, height=844):
    server, reported = server_of((1300, 800)), []
    camera = SimpleNamespace(image_width=width, image_height=height, on_update=reported.append)
    server.cameras._add(SimpleNamespace(camera=camera))
    return server, camera, lambda: reported[0](camera)


def test_a_browser_that_reports_the_first_view_later_is_turned_again():
    server, camera, report = camera_that_reports()
    shown, camera.position = camera.position, server.initial_camera.position
    report()
    assert camera.position == pytest.approx(shown)


def test_the_room_fills_the_scene_again_when_a_phone_is_turned_and_turned_back():
    _, camera, report = camera_that_reports()
    for _ in range(2):
        camera.image_width, camera.image_height = camera.image_height, camera.image_width
        report()
        expect_filled_from_the_middle(camera, room())


def test_a_view_that_somebody_has_chosen_stays_when_a_phone_is_turned():
    _, camera, report = camera_that_reports()
    camera.position = chosen = np.array((1.0, 2.0, 3.0))
    camera.image_width, camera.image_height = camera.image_height, camera.image_width
    report()
    assert camera.position is chosen


@pytest.mark.parametrize("height, shown", [(-3.0, 3.0), (0.05, LOWEST), (1.0, 1.0)])
def test_a_camera_that_is_turned_to_below_the_floor_looks_at_the_same_point_from_above(height, shown):
    _, camera, report = camera_that_reports()
    camera.position, camera.look_at = (1.0, 2.0, height), (0.5, 0.5, 0.0)
    report()
    assert (tuple(camera.position), camera.look_at) == ((1.0, 2.0, shown), (0.5, 0.5, 0.0))


@given(st.floats(-20, 20), st.floats(-20, 20), st.floats(0.1, 20), st.floats(-9, 9), st.floats(-9, 9))
def test_a_click_hits_the_floor_where_the_ray_through_it_does(x, y, height, to_x, to_y):
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
        ((0.0, 0.0, 1.0), (1.01 * MAX_CLICK, 0.0, -1.0)),
    ],
)
def test_a_click_into_the_sky_or_beyond_the_horizon_hits_nothing(origin, direction):
    assert floor_point(origin, direction) is None


def test_a_page_that_is_hidden_and_has_no_size_gets_the_first_view():
    server = server_of((0, 0))
    assert server.get_clients()[0].camera.position == pytest.approx(server.initial_camera.position)
