"""Where a robot has been: a polyline with a limited number of points."""

import math
from typing import Tuple

from ..geometry import Vector3

SPACING = 0.05  # [m] between two points
JUMP = 1.0  # [m] between two poses; beyond it the robot was placed there, and the trail starts again
LONGEST = 600  # points, 30 m
HEIGHT = 0.012  # [m] above the floor

Trail = Tuple[Vector3, ...]  # [m]


def extended(trail: Trail, x: float, y: float) -> Trail:
    """The trail with a new position [m] at its end; the same trail if that is near its end."""
    point = (x, y, HEIGHT)
    distance = math.dist(trail[-1], point) if trail else math.inf
    if distance < SPACING:
        return trail
    return (point,) if distance > JUMP else (*trail[1 - LONGEST :], point)
