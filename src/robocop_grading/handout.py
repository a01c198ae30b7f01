"""Names and figures that the lab's handout prescribes."""

import math

ACTION = "/robocop_goto_as"
ACTION_TYPE = "aro_robocop_goto_as/GoToPositionAction"
GOAL_RADIUS = 0.1  # [m] a smaller position_error means that the goal is reached
HEADING_TOLERANCE = 0.1  # [rad] within it the robot drives straight, beyond it the robot turns
STOP_DISTANCE = 0.3  # [m] a closer obstacle ahead aborts the goal
AHEAD = math.radians(30.0)  # [rad] beams within +- this angle count as ahead
