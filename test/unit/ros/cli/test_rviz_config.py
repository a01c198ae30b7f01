"""RViz's configuration: the camera shows all of the world, and what does not exist is not ticked."""

import itertools
import math

import numpy as np
import pytest
import yaml
from command import ROOT
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.ros.cli.rviz_config import (
    FIELD_OF_VIEW,
    HEIGHT,
    PITCH,
    Observed,
    adapted,
    camera,
    image_topic,
    world_box,
)

CAMERA = {"/camera/rgb/image_raw": "sensor_msgs/Image"}


def config(**seen):
    return yaml.safe_load(adapted(Observed(**seen)))


def displays(**seen):
    """The displays that are ticked, by name."""
    return {entry["Name"]: entry for entry in config(**seen)["Visualization Manager"]["Displays"] if entry["Enabled"]}


def view(**seen):
    return config(**seen)["Visualization Manager"]["Views"]["Current"]


def on_screen(low, high, aspect):
    """Where the box's corners are in the view, x, y from -1 to 1, by the camera's projection."""
    distance, focus_x, focus_y = camera((np.array(low), np.array(high)), aspect)
    for x, y, z in itertools.product((low[0], high[0]), (low[1], high[1]), (0.0, HEIGHT)):
        x, y = x - focus_x, y - focus_y
        depth = distance + y * math.cos(PITCH) - z * math.sin(PITCH)
        half_height = math.tan(FIELD_OF_VIEW / 2.0) * depth
        assert depth > 0.0
        yield x / (half_height * aspect), (y * math.sin(PITCH) + z * math.cos(PITCH)) / half_height


@given(st.tuples(*[st.floats(-20.0, 20.0)] * 2), st.tuples(*[st.floats(1.0, 12.0)] * 2), st.floats(0.5, 3.0))
def test_camera_shows_all_of_the_world_and_hardly_more(low, sides, aspect):
    positions = list(on_screen(low, (low[0] + sides[0], low[1] + sides[1]), aspect))
    assert 0.9 < np.abs(positions).max() < 1.0


@pytest.mark.parametrize("start, low, high", [(20.0, 14.0, 26.0), (49.0, 38.0, 50.0), (-3.0, -4.0, 8.0)])
def test_of_a_large_world_the_part_around_the_robot_is_shown(start, low, high):
    hall = np.array([(0.0, -2.0), (50.0, 2.0)])
    assert [*np.concatenate(world_box(hall, (start, 0.0)))] == [low, -2.0, high, 2.0]


def test_in_an_empty_world_the_robot_is_in_the_middle():
    assert [*np.concatenate(world_box(np.zeros((0, 2)), (7.0, 1.0)))] == [4.5, -1.5, 9.5, 3.5]


def test_file_that_is_opened_by_hand_shows_a_room_and_no_image():
    template = yaml.safe_load((ROOT / "rviz" / "robocop.rviz").read_text())["Visualization Manager"]
    shown = [entry["Name"] for entry in template["Displays"] if entry["Enabled"]]
    assert shown == list(displays())
    assert template["Views"]["Current"]["Target Frame"] == view()["Target Frame"] == "<Fixed Frame>"


def test_trail_is_that_of_odometry_only_where_no_server_publishes_one():
    assert "Trail" not in displays()
    assert displays(server=False)["Trail"]["Class"] == "rviz/Odometry"


def test_map_and_image_are_ticked_only_if_they_are_published():
    assert {"Map", "Image"}.isdisjoint(displays())
    shown = displays(topics={"/map": "nav_msgs/OccupancyGrid", **CAMERA})
    assert {"Map", "Image", "World", "Robot", "Scan", "Server"} < set(shown)
    assert shown["Image"]["Image Topic"] == "camera/rgb/image_raw"


def test_robot_with_a_name_is_a_marker_and_its_topics_are_in_the_namespace_where_rviz_runs():
    shown = displays(robot="red", obstacles=np.zeros((0, 2)))
    assert "Robot" not in shown and "Robot" not in displays(description=False)
    assert shown["Scan"]["Topic"] == "scan"
    assert shown["Frame red/odom"]["Reference Frame"] == "red/odom"
    tools = config(robot="red")["Visualization Manager"]["Tools"]
    assert [tool["Topic"] for tool in tools if "Topic" in tool] == ["initialpose", "move_base_simple/goal"]


def test_without_the_transform_between_them_either_the_world_or_the_robot_is_shown():
    world = displays(odom_tf=False)
    assert "World" in world and {"Robot", "Scan"}.isdisjoint(world)
    robot = displays(odom_tf=False, frame="base_footprint")
    assert {"Robot", "Scan", "Frame base_footprint"} < set(robot)
    assert {"World", "Frame map", "Frame odom"}.isdisjoint(robot)


def test_camera_is_fitted_to_the_world_in_frames_that_do_not_move_with_the_robot():
    corners = np.array([(10.0, 10.0), (15.0, 15.0)])
    for frame, target, x in (("map", "map", 12.5), ("odom", "map", 12.5), ("base_footprint", "<Fixed Frame>", 0.0)):
        seen = view(frame=frame, obstacles=corners, start=(12.0, 12.0))
        assert (seen["Target Frame"], seen["Focal Point"]["X"]) == (target, x)


@pytest.mark.parametrize(
    "screen, window", [((1024, 600), (1024, 520)), ((1920, 1080), (1920, 1000)), ((3840, 2160), (1920, 1000))]
)
def test_window_fits_on_the_screen_and_not_over_two(screen, window):
    geometry = config(screen=screen)["Window Geometry"]
    assert [geometry[name] for name in ("Width", "Height")] == [*window]
    assert not {"X", "Y"} & set(geometry)  # the window manager places it, with its title bar on the screen


@pytest.mark.parametrize(
    "namespace, image",
    [("/", "camera/rgb/image_raw"), ("/red/", "usb_cam/image_raw"), ("/blue/", "")],
)
def test_image_is_that_of_the_robots_own_colour_camera(namespace, image):
    topics = {
        **CAMERA,
        "/camera/depth/image_raw": "sensor_msgs/Image",
        "/camera/rgb/camera_info": "sensor_msgs/CameraInfo",
        "/red/usb_cam/image_raw": "sensor_msgs/Image",
        "/blue/scan": "sensor_msgs/LaserScan",
    }
    assert image_topic(topics, namespace) == image
