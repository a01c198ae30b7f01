"""What RViz shows: the newest goal stays, in a colour that says how it ended; robots can be told apart."""

import pytest
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.goto import Goal, Outcome
from aro_robocop_goto_as.params import GotoParams
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.server.markers import NOT_REACHED, REACHED, ShownGoal, server_markers
from aro_robocop_goto_as.ros.sim.world_markers import body_color, robot_markers

ODOM = Odometry(child_frame_id="base_footprint")
ODOM.header.frame_id = "odom"


def shown(goal):
    """The markers by namespace."""
    return {marker.ns: marker for marker in server_markers(GotoParams(), goal, 1.0, "base_scan", ODOM, "idle").markers}


def test_there_is_no_goal_before_the_first_one():
    assert set(shown(None)) == {"safety_cone", "robot_ring", "state"}


@pytest.mark.parametrize(
    "outcome, color",
    [(None, markers.GOAL_COLOR), (Outcome.REACHED, REACHED), (Outcome.OBSTACLE, NOT_REACHED)],
)
def test_goal_stays_when_it_has_ended_and_its_colour_says_how(outcome, color):
    made = shown(ShownGoal(Goal(1.0, -2.0), outcome))
    for name in ("goal_circle", "goal_pin"):
        assert made[name].header.frame_id == "odom"
        assert (made[name].pose.position.x, made[name].pose.position.y) == (1.0, -2.0)
        assert made[name].color == color


def test_robots_have_different_colours_and_those_named_after_a_colour_have_that_one():
    robots = [(f"robot_{number}", f"robot_{number}/base_footprint", 0.1) for number in range(1, 7)]
    bodies = [marker.color for marker in robot_markers(robots) if marker.ns == "robots"]
    assert len({(color.r, color.g, color.b) for color in bodies}) == 6
    red, blue = (body_color(name, 1) for name in ("red", "blue"))
    assert red.r > 2 * red.b and blue.b > 2 * blue.r
