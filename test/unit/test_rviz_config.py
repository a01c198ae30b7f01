"""RViz's configuration: the camera shows all of the world, and displays are there only for what exists."""

import dataclasses
import itertools
import math
from pathlib import Path

import pytest
import yaml
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import MapMetaData
from visualization_msgs.msg import Marker

from aro_robocop_goto_as.geometry import quaternion_from_rpy
from aro_robocop_goto_as.ros.cli.rviz_scene import corners_of, image_topic, map_corners
from aro_robocop_goto_as.rviz.camera import FIELD_OF_VIEW, PITCH, Extent, fitting
from aro_robocop_goto_as.rviz.config import Scene, Window, grading_watch, robocop

ROOT = Path(__file__).resolve().parents[2]
ALWAYS = ["Grid", "All frames"]


def displays(scene):
    """The displays by name."""
    return {entry["Name"]: entry for entry in yaml.safe_load(robocop(scene))["Visualization Manager"]["Displays"]}


def on_screen(extent, aspect):
    """Where the extent's corners are in the view, x, y from -1 to 1, by the camera's projection."""
    camera = fitting(extent, aspect)
    (x_low, y_low), (x_high, y_high) = extent.low, extent.high
    for x, y, z in itertools.product((x_low, x_high), (y_low, y_high), (0.0, extent.height)):
        x, y = x - camera.x, y - camera.y
        depth = camera.distance + y * math.cos(PITCH) - z * math.sin(PITCH)
        half_height = math.tan(FIELD_OF_VIEW / 2.0) * depth
        assert depth > 0.0
        yield x / (half_height * aspect), (y * math.sin(PITCH) + z * math.cos(PITCH)) / half_height


@given(
    st.tuples(*[st.floats(-20.0, 20.0)] * 2),
    st.tuples(*[st.floats(1.0, 12.0)] * 2),
    st.floats(0.0, 1.0),
    st.floats(0.5, 3.0),
)
def test_camera_shows_all_of_the_extent_and_hardly_more(low, sides, height, aspect):
    extent = Extent(low, (low[0] + sides[0], low[1] + sides[1]), height)
    positions = [abs(position) for corner in on_screen(extent, aspect) for position in corner]
    assert 0.9 < max(positions) < 1.0


def test_of_a_large_world_the_part_around_the_robot_is_shown():
    hall = Extent((0.0, -2.0), (50.0, 2.0))
    assert hall.limited(12.0, 20.0, 0.0) == Extent((14.0, -2.0), (26.0, 2.0))
    assert hall.limited(12.0, 49.0, 0.0) == Extent((38.0, -2.0), (50.0, 2.0))
    assert hall.with_point(-3.0, 0.0, 1.0).low == (-4.0, -2.0)


def test_file_that_can_be_opened_by_hand_is_the_generated_one():
    assert (ROOT / "rviz" / "robocop.rviz").read_text() == robocop(Scene()), (
        "write it anew: ./robocop shell python3 -c 'from aro_robocop_goto_as.rviz.config import *; "
        'open("rviz/robocop.rviz", "w").write(robocop(Scene()))\''
    )


def test_nothing_is_displayed_that_does_not_exist():
    nothing = Scene(world=False, model=False, scan=False, trail=False, axes=(), server=False)
    assert list(displays(nothing)) == ALWAYS
    assert {"Map", "Image"}.isdisjoint(displays(Scene()))
    everything = displays(dataclasses.replace(Scene(), grid_map=True, image="camera/rgb/image_raw"))
    assert {"Map", "World", "Robot", "Scan", "Trail", "Server", "Image"} < set(everything)
    assert everything["Image"]["Image Topic"] == "camera/rgb/image_raw"


def test_only_a_scene_with_a_camera_has_a_panel_for_its_image():
    panels = [yaml.safe_load(robocop(Scene(image=topic)))["Window Geometry"] for topic in ("", "camera/rgb/image_raw")]
    assert ["Image" in panel for panel in panels] == [False, True]


def test_window_has_the_given_place_and_size():
    for text in (robocop(Scene(window=Window(10, 20, 800, 600))), grading_watch(Window(10, 20, 800, 600))):
        geometry = yaml.safe_load(text)["Window Geometry"]
        assert [geometry[name] for name in ("X", "Y", "Width", "Height")] == [10, 20, 800, 600]


def test_topics_are_those_of_the_namespace_in_which_rviz_runs():
    shown = displays(Scene())
    assert [shown["Scan"]["Topic"], shown["Trail"]["Topic"]] == ["scan", "odom"]
    tools = yaml.safe_load(robocop(Scene()))["Visualization Manager"]["Tools"]
    assert [tool["Topic"] for tool in tools if "Topic" in tool] == ["initialpose", "move_base_simple/goal"]


def test_corners_are_those_of_the_obstacle_where_it_stands():
    turned = Pose(Point(1.0, 2.0, 0.25), Quaternion(*quaternion_from_rpy(0.0, 0.0, math.pi / 2.0)))
    wall = Marker(ns="world", type=Marker.CUBE, pose=turned, scale=Vector3(4.0, 0.2, 0.5))
    corners = corners_of(wall)
    assert corners.min(axis=0) == pytest.approx([0.9, 0.0, 0.0])
    assert corners.max(axis=0) == pytest.approx([1.1, 4.0, 0.5])
    mesh = Marker(ns="world", type=Marker.TRIANGLE_LIST, pose=turned, points=[Point(1.0, 0.0, 0.0)])
    assert corners_of(mesh).tolist() == [pytest.approx([1.0, 3.0, 0.25])]
    assert len(corners_of(Marker(ns="robots", type=Marker.CYLINDER))) == 0


def test_corners_of_a_map_are_those_of_its_cells():
    origin = Pose(Point(-4.0, -3.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
    corners = map_corners(MapMetaData(resolution=0.1, width=80, height=60, origin=origin))
    assert (*corners.min(axis=0), *corners.max(axis=0)) == pytest.approx((-4.0, -3.0, 0.0, 4.0, 3.0, 0.0))


@pytest.mark.parametrize(
    "namespace, image",
    [("/", "camera/rgb/image_raw"), ("/red/", "usb_cam/image_raw"), ("/blue/", "")],
)
def test_image_is_that_of_the_robots_own_colour_camera(namespace, image):
    topics = {
        "/camera/depth/image_raw": "sensor_msgs/Image",
        "/camera/rgb/image_raw": "sensor_msgs/Image",
        "/camera/rgb/camera_info": "sensor_msgs/CameraInfo",
        "/red/usb_cam/image_raw": "sensor_msgs/Image",
        "/blue/scan": "sensor_msgs/LaserScan",
    }
    assert image_topic(topics, namespace) == image
