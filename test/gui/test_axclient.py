"""A goal typed into actionlib's graphical client and sent by its button is reached."""

import math

import pytest
from desktop import Desktop, Recorder, Ros
from waiting import wait_for

SUCCEEDED = 3  # actionlib_msgs/GoalStatus
SERVER = "/aro_robocop_goto_as_node"
GOAL = (0.4, -0.3)  # [m] in odom, free in stage_4
TOLERANCE = 0.1  # [m] config/goto_as.yaml, position_tolerance
# Colours of axclient.py's two status lines, at the bottom of its window.
CONNECTED, NO_GOAL, GOAL_SUCCEEDED = (192, 252, 253), (200, 0, 0), (38, 250, 253)
WHITE = (255, 255, 255)  # of its text fields


def rows(pixels, color):
    """Rows [pixel] of a window whose most frequent colour is this one."""
    return [row for row, line in enumerate(pixels) if 2 * (line == color).all(axis=1).sum() > len(line)]


def layout(pixels):
    """Rows [pixel] of the goal's text and of the button SEND GOAL; None until the button is enabled.

    From the top: three text fields for goal, feedback and result; the buttons SEND GOAL and CANCEL GOAL, of the same
    height; a line for the goal's state; a line for the server's.
    """
    fields, state, server = rows(pixels, WHITE), rows(pixels, NO_GOAL), rows(pixels, CONNECTED)
    if not (fields and state and server):
        return None
    return fields[0] + 10, fields[-1] + (state[0] - fields[-1]) // 4


@pytest.mark.slow
def test_goal_sent_from_axclient_is_reached(tmp_path):
    with Desktop(tmp_path, "800x600x24") as desktop, Ros(tmp_path, desktop, "rviz:=false") as ros:
        results = Recorder(ros, SERVER, "/robocop_goto_as/result")
        wait_for(results.connected, "results recorded")
        program = "rosrun actionlib_tools axclient.py /robocop_goto_as aro_robocop_goto_as/GoToPositionAction".split()
        ros.start("axclient", *program, signals=())  # only SIGKILL ends it
        window = wait_for(lambda: desktop.window("GUI Client$"), "axclient's window")
        text, button = wait_for(lambda: layout(desktop.pixels(window)), "axclient connected to the server")

        x, y, width, _ = desktop.geometry(window)
        goal = "position: {{x: {}, y: {}, z: 0.0}}".format(*GOAL)
        desktop.input("mousemove", x + width // 2, y + text, "click", 1, "key", "ctrl+a", "type", goal)
        desktop.input("mousemove", x + width // 2, y + button, "click", 1)

        result = wait_for(results.messages, "the goal's result")[0]
        assert result["status"]["status"] == SUCCEEDED, result
        assert result["result"]["success"] is True
        assert result["result"]["message"].startswith("REACHED")
        assert "/axclient" in result["status"]["goal_id"]["id"]
        assert "goal accepted: x {:.2f} y {:.2f} in odom".format(*GOAL) in (tmp_path / "roslaunch.log").read_text()
        robot = ros.latest("/odom")["pose"]["pose"]["position"]
        assert math.hypot(robot["x"] - GOAL[0], robot["y"] - GOAL[1]) < TOLERANCE
        wait_for(lambda: rows(desktop.pixels(window), GOAL_SUCCEEDED), "axclient shows that the goal succeeded")
