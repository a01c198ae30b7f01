"""What RViz shows of the server: the newest goal stays, in a colour that says how it ended."""

from types import SimpleNamespace

import pytest
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from visualization_msgs.msg import Marker

from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.goto.rule import Goal, Outcome
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.markers import BLOCKED, FREE, NEAR, UNKNOWN
from aro_robocop_goto_as.ros.server import server_markers

ODOM, SCAN = Odometry(child_frame_id="base_footprint"), LaserScan()
ODOM.header.frame_id, SCAN.header.frame_id = "odom", "base_scan"
INPUTS = SimpleNamespace(odom=SimpleNamespace(message=ODOM), scan=SimpleNamespace(message=SCAN), clearance=lambda: 1.0)


def shown(goal, trail=()):
    """The markers by namespace."""
    return {
        marker.ns: marker for marker in server_markers.server_markers(GotoParams(), INPUTS, goal, "idle", trail).markers
    }


def test_there_is_no_goal_before_the_first_one_and_after_a_reset():
    assert {name for name, marker in shown(None).items() if marker.action == Marker.DELETE} == {*markers.GOAL, "trail"}


@pytest.mark.parametrize("outcome, stays", [(Outcome.OBSTACLE, False), (None, True)])
def test_a_goal_that_has_ended_is_gone_when_the_robot_is_placed_elsewhere(monkeypatch, outcome, stays):
    published = []
    topic = SimpleNamespace(get_num_connections=lambda: 1, publish=published.append)
    monkeypatch.setattr(server_markers.rospy, "Publisher", lambda *_, **__: topic)
    monkeypatch.setattr(server_markers.rospy, "Timer", lambda *_, **__: None)
    odom = Odometry(child_frame_id="base_footprint")
    inputs = SimpleNamespace(odom=SimpleNamespace(message=odom, stamp_ns=0), scan=None)
    display = server_markers.Display(SimpleNamespace(params=GotoParams()), inputs)
    display.newest, display.state = SimpleNamespace(goal=Goal(1.0, -2.0), outcome=outcome), "OBSTACLE"
    for x in (0.0, 1.0):
        odom.pose.pose.position.x, inputs.odom.stamp_ns = x, inputs.odom.stamp_ns + 10**8
        display._publish(None)
    assert (display.newest is not None, display.state) == (stays, "OBSTACLE" if stays else server_markers.IDLE)


@pytest.mark.parametrize(
    "outcome, color",
    [(None, markers.GOAL_COLOR), (Outcome.REACHED, markers.REACHED), (Outcome.OBSTACLE, markers.NOT_REACHED)],
)
def test_goal_stays_when_it_has_ended_and_its_colour_says_how(outcome, color):
    made = shown(SimpleNamespace(goal=Goal(1.0, -2.0), outcome=outcome))
    for name in ("goal_circle", "goal_pin"):
        assert made[name].header.frame_id == "odom"
        assert (made[name].pose.position.x, made[name].pose.position.y) == (1.0, -2.0)
        assert made[name].color == color


@pytest.mark.parametrize("clearance, color", [(None, UNKNOWN), (0.29, BLOCKED), (0.31, NEAR), (0.61, FREE)])
def test_sector_ahead_says_by_its_colour_how_near_an_obstacle_is(clearance, color):
    assert server_markers.cone_color(clearance, 0.3) == color


def test_trail_is_a_line_in_odom_which_is_removed_when_it_starts_again():
    line = shown(None, ((0.0, 0.0, 0.01), (0.1, 0.0, 0.01)))["trail"]
    assert (line.action, line.header.frame_id, line.points[1].x) == (Marker.ADD, "odom", 0.1)
    assert shown(None, ((0.0, 0.0, 0.01),))["trail"].action == Marker.DELETE
