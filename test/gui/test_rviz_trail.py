"""RViz's trail follows the robot, and is gone when a reset has put the robot back to its start."""

import subprocess

import numpy as np
import pytest
from desktop import Desktop, Recorder, Ros
from test_rviz_nav_goal import SERVER, view_of_the_robot
from waiting import DEADLINE, wait_for

from aro_robocop_goto_as.ros.markers import TRAIL_COLOR

pytestmark = pytest.mark.slow
GOAL = "{goal: {position: {x: 0.9}}}"


def width_of_blue(desktop, canvas):
    """How many columns of the view have the colour of the trail, which is also that of the ring around the robot."""
    pixels = desktop.pixels(canvas)
    color = np.array((TRAIL_COLOR.r, TRAIL_COLOR.g, TRAIL_COLOR.b))
    length = np.maximum(np.linalg.norm(pixels, axis=-1), 1.0)
    return int((((pixels @ color) / length / np.linalg.norm(color) > 0.99) & (length > 150.0)).any(axis=0).sum())


def test_a_reset_removes_the_trail(tmp_path):
    with Desktop(tmp_path) as desktop, Ros(tmp_path, desktop, "rviz:=true") as ros:
        results = Recorder(ros, SERVER, "/robocop_goto_as/result")
        canvas = wait_for(lambda: view_of_the_robot(desktop, ros), "scan and safety cone drawn in RViz")
        wait_for(results.connected, "results recorded")
        ring = width_of_blue(desktop, canvas)

        action = ("/robocop_goto_as/goal", "aro_robocop_goto_as/GoToPositionActionGoal", GOAL)
        ros.start("goal", "rostopic", "pub", "-1", *action)
        wait_for(results.messages, "the goal's result")
        wait_for(lambda: width_of_blue(desktop, canvas) > 1.5 * ring, f"a trail beside the ring of {ring} columns")

        reset = ["rosservice", "call", "/robocop_sim/reset", "0"]
        subprocess.run(reset, env=ros.environment, check=True, timeout=DEADLINE, stdout=subprocess.DEVNULL)
        wait_for(lambda: width_of_blue(desktop, canvas) < 1.1 * ring, f"only the ring of {ring} columns")
