"""RViz shows the walls and all robots, and no display in red, whether it is opened before the simulator or after it."""

from pathlib import Path

import numpy as np
import pytest
from desktop import Desktop, Master, Ros
from waiting import wait_for

CONFIG = Path(__file__).resolve().parents[2] / "rviz" / "robocop.rviz"
pytestmark = pytest.mark.slow
TITLE = " - RViz$"
ERROR, WARNING = (192, 32, 32), (192, 192, 32)  # red, green, blue of names in RViz's Displays panel
BODIES = ((0.35, 0.78, 0.98), (0.98, 0.80, 0.25), (0.60, 0.86, 0.35))  # of three robots, in any light


def shown(view):
    """The parts of the scene in the pixels of RViz's view, recognised by their colours."""
    red, green, blue = view[..., 0], view[..., 1], view[..., 2]
    walls = (red > 55) & (red < 120) & (blue > red + 8) & (blue < red + 30) & (green > red)
    lidar = (blue > 90) & (2 * red < blue) & (1.5 * green < blue)
    found = {"walls": walls.sum() > 60000, "robot": lidar.sum() > 40}
    length = np.maximum(np.linalg.norm(view, axis=-1), 1.0)
    for number, color in enumerate(BODIES, 1):
        alike = view @ np.array(color) / length / np.linalg.norm(color) > 0.995
        found[f"robot_{number}"] = (alike & (length > 120.0)).sum() > 200
    return {part for part, is_shown in found.items() if is_shown}


def problems(panel):
    """How many pixels of the Displays panel say that a display has an error or a warning."""
    return sum(int((panel == color).all(axis=-1).sum()) for color in (ERROR, WARNING))


def complete(desktop, parts):
    """Whether RViz shows these parts, and no display has a problem."""
    window = desktop.window(TITLE)
    canvas = window and desktop.canvas(window)
    if not canvas:
        return False
    left = desktop.geometry(canvas)[0]
    return shown(desktop.pixels(canvas)) >= parts and not problems(desktop.pixels(window)[:, :left])


def test_rviz_that_was_opened_before_the_simulator_shows_everything(tmp_path):
    with Desktop(tmp_path) as desktop, Master(tmp_path, desktop) as ros:
        ros.start("rviz", "rviz", "-d", CONFIG)
        wait_for(lambda: desktop.window(TITLE) and desktop.canvas(desktop.window(TITLE)), "RViz")
        ros.start("sim", "roslaunch", "aro_robocop_goto_as", "robocop_sim.launch", "moving:=true")
        wait_for(lambda: complete(desktop, {"walls", "robot"}), "walls and robot")


def test_rviz_that_is_opened_late_shows_everything_of_several_robots(tmp_path):
    with Desktop(tmp_path) as desktop, Ros(tmp_path, desktop, "rviz:=false", "robots:=3") as ros:
        wait_for(lambda: ros.subscriber("/robot_1/scan", "/"), "the server")
        rviz = ["rosrun", "aro_robocop_goto_as", "robocop_rviz.py", "--config", "robots.rviz"]
        ros.start("rviz", "env", "ROS_NAMESPACE=/robot_1", *rviz)
        wait_for(lambda: complete(desktop, {"walls", "robot_1", "robot_2", "robot_3"}), "walls and three robots")
        desktop.quit_by_menu(desktop.window(TITLE))
        wait_for(lambda: desktop.window(TITLE) is None, "RViz closed")
