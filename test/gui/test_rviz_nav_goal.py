"""The robot drives to a 2D Nav Goal clicked in RViz."""

import math
from pathlib import Path

import pytest
import yaml
from desktop import Desktop, Recorder, Ros
from waiting import wait_for

CONFIG = Path(__file__).resolve().parents[2] / "rviz" / "robocop.rviz"
SUCCEEDED = 3  # actionlib_msgs/GoalStatus
TOLERANCE = 0.1  # [m] config/goto_as.yaml, position_tolerance
ODOMETRY_ERROR = 0.02  # [m] of wheel encoders on the 0.7 m to the goal
SIMULATOR, SERVER, BRIDGE = "/robocop_sim", "/aro_robocop_goto_as_node", "/robocop_rviz_goto_ac_node"
SEEN = [(SIMULATOR, topic) for topic in ("/tf", "/tf_static", "/scan", "/robocop_sim/world")] + [
    (SERVER, "/aro_robocop_goto_as_node/markers")
]  # the topics that RViz displays, with their publishers


def displays_the_robot(pixels):
    """Whether RViz's view shows the red scan and the green safety cone of a robot without an obstacle ahead."""
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    scan = (red > 140) & (2 * green < red) & (2 * blue < red)
    cone = (green > 70) & (2 * red < green) & (1.5 * blue < green)
    return scan.sum() > 300 and cone.sum() > 100


def view_of_the_robot(desktop, ros):
    """RViz's view, once it shows the robot. Looked for from the start each time: an RViz that crashes is restarted."""
    window = desktop.window(" - RViz$")
    canvas = window and desktop.canvas(window)
    if canvas and all(ros.linked(node, "/rviz", topic) for node, topic in SEEN):
        return canvas if displays_the_robot(desktop.pixels(canvas)) else None
    return None


def view_centre():
    """Where the middle of the view is, x, y [m] in map: the focal point in the configuration that RViz was given."""
    focus = yaml.safe_load(CONFIG.read_text())["Visualization Manager"]["Views"]["Current"]["Focal Point"]
    return focus["X"], focus["Y"]


def click_and_drag_up(desktop, canvas):
    """Use the tool 2D Nav Goal: press the button at the position, drag in the direction to face."""
    x, y, width, height = desktop.geometry(canvas)
    x, y = x + width // 2, y + height // 2
    desktop.input("mousemove", x, y, "key", "g", "mousedown", 1)
    for up in range(10, 101, 10):
        desktop.input("mousemove", x, y - up)
    desktop.input("mouseup", 1)


def test_robot_drives_to_a_2d_nav_goal_clicked_in_rviz(tmp_path):
    with Desktop(tmp_path) as desktop, Ros(tmp_path, desktop, "rviz:=true") as ros:
        clicks = Recorder(ros, "/rviz", "/move_base_simple/goal")
        results = Recorder(ros, SERVER, "/robocop_goto_as/result")
        canvas = wait_for(lambda: view_of_the_robot(desktop, ros), "scan and safety cone drawn in RViz")
        wait_for(lambda: ros.linked(BRIDGE, "/rviz", "/move_base_simple/goal"), "the bridge connected to RViz")
        wait_for(clicks.connected, "clicks recorded")
        wait_for(results.connected, "results recorded")

        click_and_drag_up(desktop, canvas)

        click = wait_for(clicks.messages, "RViz's goal on /move_base_simple/goal")[0]
        assert click["header"]["frame_id"] == "map"
        position, orientation = click["pose"]["position"], click["pose"]["orientation"]
        assert (position["x"], position["y"]) == pytest.approx(view_centre(), abs=0.05)
        assert 2.0 * math.atan2(orientation["z"], orientation["w"]) == pytest.approx(math.pi / 2.0, abs=0.05)

        result = wait_for(results.messages, "the goal's result")[0]
        assert result["status"]["status"] == SUCCEEDED, result
        assert result["result"]["success"] is True
        assert result["result"]["message"].startswith("REACHED")
        truth = ros.latest("/ground_truth_odom")  # its frame, world, coincides with map
        robot = truth["pose"]["pose"]["position"]
        assert math.hypot(robot["x"] - position["x"], robot["y"] - position["y"]) < TOLERANCE + ODOMETRY_ERROR
        assert (len(clicks.messages()), len(results.messages())) == (1, 1)
