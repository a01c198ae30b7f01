"""Names in ROS: of the lab's package, nodes and action, of a robot's topics and frames, of places. Imports no ROS."""

import os
from pathlib import Path

PACKAGE = "aro_robocop_goto_as"
ROOT = Path(__file__).resolve().parents[2]  # of the checkout
SIMULATOR, WEB = "robocop_sim", "robocop_web"  # nodes
SERVER, BRIDGE = "aro_robocop_goto_as_node", "robocop_rviz_goto_ac_node"  # nodes, fixed by the handout
COMMAND_VARIABLE = "ROBOCOP_COMMAND"  # set in the container image
ACTION = "robocop_goto_as"  # fixed by the handout
ACTION_TYPE = f"{PACKAGE}/GoToPositionAction"
# Frames, of REP-105 and the robots' URDFs; of several robots, all but the first two get the robot's name as a prefix.
WORLD_FRAME, MAP_FRAME = "world", "map"  # the world is that of ground truth; it coincides with map
ODOM_FRAME, FOOTPRINT_FRAME = "odom", "base_footprint"
SCAN_FRAME, IMU_FRAME = "base_scan", "imu_link"


def robocop() -> str:
    """The command line by which a user calls ./robocop in another terminal."""
    return os.environ.get(COMMAND_VARIABLE) or "./robocop"


def prefixed(robot: str, name: str) -> str:
    """A robot's topic or frame, NAME or ROBOT/NAME; topics are relative, so namespaces and remappings apply to them."""
    return f"{robot}/{name}" if robot else name


def absolute(robot: str, name: str) -> str:
    """A topic of a robot, or of a node that acts for it: /NAME or /ROBOT/NAME, whatever this node's namespace is."""
    return "/" + prefixed(robot.strip("/"), name)


def absolute_if_named(robot: str, name: str) -> str:
    """The topic /ROBOT/NAME of a robot that a user named; without a robot, NAME in this node's namespace."""
    return absolute(robot, name) if robot else name


def position_text(x: float, y: float, frame: str) -> str:
    """A position [m] in words, as messages name it."""
    return f"x {x:.2f} y {y:.2f} in {frame}"
