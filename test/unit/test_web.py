"""The web page without ROS and browser: who is answered, when a robot stops, frames, clicks, texts, descriptions."""

import math
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import ROOT

from aro_robocop_goto_as.errors import RobotModelError
from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Pose3D, Twist2D, lifted
from aro_robocop_goto_as.web import text
from aro_robocop_goto_as.web.access import is_loopback, refusal, url
from aro_robocop_goto_as.web.dead_man import DeadMan, Drive
from aro_robocop_goto_as.web.frames import FrameTree
from aro_robocop_goto_as.web.pick import FARTHEST_CLICK, floor_point
from aro_robocop_goto_as.web.series import Series
from aro_robocop_goto_as.web.shapes import BOX, CYLINDER
from aro_robocop_goto_as.web.state import REMEMBERED, GoalHistory, ReplayState
from aro_robocop_goto_as.web.trail import Trail
from aro_robocop_goto_as.web.urdf import read_links

FORWARD = Twist2D(0.2, 0.0)
PROXY = "https://proxy.example"


# -- who is answered --


@pytest.mark.parametrize(
    "host", ["localhost:8080", "127.0.0.1:8080", "[::1]:8080", "192.168.1.5", "LOCALHOST", "pc-7:80"]
)
def test_requests_of_our_own_page_and_without_an_origin_are_answered(host: str) -> None:
    assert refusal([host], [f"http://{host}"], ["pc-7"], []) == ""
    assert refusal([host], [], ["pc-7"], []) == ""


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "http://localhost:9999",
        "http://localhost",
        "http://localhost:8080.evil.example",
        "http://evil.example/localhost:8080",
        "null",
        "",
        "file://localhost:8080",
        "chrome-extension://localhost:8080",
    ],
)
def test_requests_of_other_origins_are_refused(origin: str) -> None:
    assert refusal(["localhost:8080"], [origin], [], [])


def test_a_name_that_was_made_to_point_here_is_refused_although_page_and_request_agree() -> None:
    assert refusal(["evil.example:8080"], ["http://evil.example:8080"], [], [])


@pytest.mark.parametrize("hosts", [[], ["localhost", "evil.example"], [""], ["["], ["[::1"]])
def test_a_missing_double_or_malformed_host_is_refused(hosts: "list[str]") -> None:
    assert refusal(hosts, [], [], [])


def test_several_origins_are_refused() -> None:
    assert refusal(["localhost"], ["http://localhost", "http://evil.example"], [], [])


def test_an_origin_that_is_allowed_is_answered_and_no_other_one() -> None:
    assert refusal(["localhost:8080"], [PROXY], [], [PROXY]) == ""
    assert refusal(["localhost:8080"], [PROXY + ".evil.example"], [], [PROXY])


@given(st.text(), st.text())
def test_any_text_as_host_and_origin_gives_an_answer(host: str, origin: str) -> None:
    assert isinstance(refusal([host], [origin], ["pc-7"], []), str)


def test_loopback_addresses_are_told_from_those_that_others_reach() -> None:
    assert [is_loopback(name) for name in ("127.0.0.1", "::1", "localhost", "127.9.9.9")] == [True] * 4
    assert [is_loopback(name) for name in ("0.0.0.0", "::", "192.168.1.5", "pc-7", "")] == [False] * 5


def test_a_server_on_all_addresses_is_opened_at_localhost() -> None:
    assert {url(host, 80) for host in ("127.0.0.1", "::1", "0.0.0.0", "::")} == {"http://localhost:80"}
    assert url("192.168.1.5", "8090") == "http://192.168.1.5:8090"


# -- the dead-man's switch --


def test_the_robot_drives_while_requests_are_renewed_and_is_stopped_once_when_they_end() -> None:
    dead_man = DeadMan(patience=0.3)
    for now in (0.0, 0.1, 0.2):
        dead_man.request(1, "red", FORWARD, now)
        assert dead_man.command(now) == Drive("red", FORWARD)
    assert dead_man.command(0.49) == Drive("red", FORWARD)
    assert dead_man.command(0.51) == Drive("red", STANDSTILL)
    assert dead_man.command(0.6) is None and not dead_man.active


def test_a_release_stops_the_robot_at_once() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.release(1)
    assert dead_man.active
    assert dead_man.command(0.01) == Drive("", STANDSTILL)
    assert dead_man.command(0.02) is None


def test_a_page_that_goes_does_not_stop_the_robot_that_another_one_drives() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.request(2, "", FORWARD, 0.1)
    dead_man.release(1)
    assert dead_man.command(0.1) == Drive("", FORWARD)


def test_whoever_presses_stop_stops_the_robot_of_another_page() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.stop()
    assert dead_man.command(0.01) == Drive("", STANDSTILL)


def test_the_former_robot_is_stopped_before_the_next_one_drives() -> None:
    dead_man = DeadMan()
    dead_man.request(1, "red", FORWARD, 0.0)
    dead_man.command(0.0)
    dead_man.request(1, "blue", FORWARD, 0.1)
    assert dead_man.command(0.1) == Drive("red", STANDSTILL)
    assert dead_man.command(0.1) == Drive("blue", FORWARD)


def test_only_the_first_request_begins_a_drive() -> None:
    dead_man = DeadMan(patience=0.3)
    begins = [dead_man.request(1, "", FORWARD, now) for now in (0.0, 0.1, 0.2, 0.6)]
    assert begins == [True, False, False, True]


@given(st.lists(st.tuples(st.floats(0.0, 0.5), st.sampled_from(["request", "release", "stop", "tick"])), max_size=40))
def test_no_command_but_zero_is_sent_later_than_the_patience_after_the_last_request(steps: "list") -> None:
    dead_man, now, asked = DeadMan(patience=0.3), 0.0, -math.inf
    for wait, what in steps:
        now += wait
        if what == "request":
            dead_man.request(1, "", FORWARD, now)
            asked = now
        elif what == "release":
            dead_man.release(1)
            asked = -math.inf
        elif what == "stop":
            dead_man.stop()
            asked = -math.inf
        command = dead_man.command(now)
        assert (command == Drive("", FORWARD)) == (now < asked + 0.3)


# -- frames --


def test_frames_are_looked_up_along_parents_and_siblings() -> None:
    tree = FrameTree()
    tree.update("map", "odom", lifted(Pose2D(1.0, 0.0, math.pi / 2.0)))
    tree.update("odom", "base", lifted(Pose2D(2.0, 0.0, 0.0)))
    tree.update("map", "world", lifted(Pose2D(0.0, 5.0, 0.0)))
    found = tree.lookup("map", "base")
    assert found is not None
    assert found.position == pytest.approx((1.0, 2.0, 0.0))
    sibling = tree.lookup("world", "base")
    assert sibling is not None and sibling.position == pytest.approx((1.0, -3.0, 0.0))
    back = tree.lookup("base", "map")
    assert back is not None and back.position == pytest.approx((-2.0, 1.0, 0.0))


def test_frames_that_are_not_connected_give_no_pose() -> None:
    tree = FrameTree()
    tree.update("map", "odom", Pose3D())
    tree.update("other", "base", Pose3D())
    assert tree.lookup("map", "base") is None
    assert tree.lookup("map", "nowhere") is None
    assert tree.lookup("nowhere", "nowhere") == Pose3D()
    assert tree.names() == ["map", "other", "base", "odom"]


def test_an_older_transform_replaces_a_newer_one_as_after_a_restart_of_the_simulator() -> None:
    tree = FrameTree()
    tree.update("map", "odom", lifted(Pose2D(9.0, 0.0)))
    tree.update("map", "odom", lifted(Pose2D(1.0, 0.0)))
    found = tree.lookup("map", "odom")
    assert found is not None and found.position[0] == 1.0


def test_a_loop_of_frames_ends_the_search() -> None:
    tree = FrameTree()
    tree.update("a", "b", Pose3D())
    tree.update("b", "a", Pose3D())
    assert tree.lookup("map", "a") is None


# -- clicks --


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
    assert FARTHEST_CLICK < 1e6


# -- trail and plots --


def test_a_trail_has_a_point_for_each_distance_and_a_limited_length() -> None:
    trail = Trail(longest=10)
    added = [trail.add(step / 64.0, 0.0) for step in range(100)]
    segments = trail.segments(0.2)
    assert sum(added) == 25 and segments.shape == (9, 2, 3)
    assert (segments[:-1, 1] == segments[1:, 0]).all() and segments[..., 2] == pytest.approx(0.2)


def test_a_trail_begins_anew_where_the_robot_was_placed() -> None:
    trail = Trail()
    trail.add(0.0, 0.0)
    trail.add(0.1, 0.0)
    assert trail.add(5.0, 5.0)
    assert trail.segments(0.0).shape == (0, 2, 3)


def test_a_plot_shows_the_last_seconds_relative_to_now() -> None:
    series = Series(2, span=10.0)
    for second in range(30):
        series.add(float(second), float(second), -float(second))
    times, first, second = series.columns(29.0)
    assert times.tolist() == [float(t) for t in range(-10, 1)]
    assert first[-1] == 29.0 and second[-1] == -29.0
    assert not series.changed


def test_a_plot_without_samples_is_not_empty() -> None:
    assert [column.shape for column in Series(2).columns(5.0)] == [(1,)] * 3


# -- texts --


def test_markup_in_names_and_messages_is_shown_as_text() -> None:
    attack = "<img src=x onerror=alert(1)>"
    history = GoalHistory()
    history.ended(attack, "id", attack, attack)
    for content in (text.alert(attack), text.feedback(1.0, 2.0, attack), text.history(history.latest(), True)):
        assert "<img" not in content and "&lt;img" in content
    assert "<img" not in text.overview(None, 2, attack)


def test_an_endless_message_is_cut() -> None:
    assert len(text.plain("x" * 10_000)) == text.LONGEST


def test_the_history_holds_the_last_goals_with_their_positions() -> None:
    history = GoalHistory()
    for number in range(3 * REMEMBERED):
        history.sent(f"goal {number}", float(number), 0.0)
    last = 3 * REMEMBERED - 1
    history.ended("", f"goal {last}", "SUCCEEDED", "REACHED")
    history.ended("", "goal 0", "ABORTED", "OBSTACLE")
    newest, older = history.latest()
    assert older.goal == (float(last), 0.0) and newest.goal is None
    for _ in range(3 * REMEMBERED):
        history.ended("", "x", "ABORTED", "")
    assert len(history.latest()) == REMEMBERED


# -- descriptions --

URDF = """<robot name="r"><!-- a comment -->
  <material name="blue"><color rgba="0 0 1 0.5"/></material>
  <link name="base">
    <visual><origin xyz="1 2 3"/><geometry><box size="1 2 3"/></geometry><material name="blue"/></visual>
    <visual><geometry><!-- none --><cylinder radius="0.5" length="2"/></geometry></visual>
    <visual><geometry><mesh filename="package://nowhere/mesh.stl"/></geometry></visual></link>
  <link name="empty"/></robot>"""


def test_a_description_is_read_with_its_colours_and_without_meshes_that_are_not_there() -> None:
    links = read_links(URDF)
    assert links["empty"] == []
    (box, where), (cylinder, _) = links["base"]
    assert (box.kind, box.size, box.color, box.opacity) == (BOX, (1.0, 2.0, 3.0), (0, 0, 255), 0.5)
    assert where.position == (1.0, 2.0, 3.0)
    assert (cylinder.kind, cylinder.size) == (CYLINDER, (1.0, 1.0, 2.0))


@pytest.mark.parametrize(
    "urdf, reason",
    [
        ("", "not XML"),
        ("<robot", "not XML"),
        ("<sdf/>", "expected <robot>, got <sdf>"),
        (URDF.replace("1 2 3", "1 2"), "robot_description"),
        (URDF.replace('"0.5"', '"wide"'), "robot_description"),
    ],
)
def test_what_is_no_description_is_refused_with_the_reason(urdf: str, reason: str) -> None:
    with pytest.raises(RobotModelError, match=reason):
        read_links(urdf)


def test_the_descriptions_of_all_models_are_drawn() -> None:

    for name in os.listdir(os.path.join(ROOT, "urdf")):
        with open(os.path.join(ROOT, "urdf", name)) as stream:
            links = read_links(stream.read())
        assert sum(map(len, links.values())) >= 10, name
        assert all(np.isfinite(shape.size).all() for shapes in links.values() for shape, _ in shapes)


def test_a_recording_says_where_it_is_and_how_fast_it_goes() -> None:
    assert "12 of 60 s, factor 0.5" in text.progress(ReplayState(12.3, 60.0, True, 0.5))
    assert "60 of 60 s, paused" in text.progress(ReplayState(60.0, 60.0, False, 2.0))
