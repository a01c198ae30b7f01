"""Where a robot has been, as RViz and the page show it: a polyline with a limited number of points."""

import math
from typing import Optional, Tuple

from ..geometry import Vector3

SPACING = 0.05  # [m] between two points
MAX_POINTS = 600  # points, 30 m
HEIGHT = 0.012  # [m] above the floor
# A robot that moves farther between two poses was placed there, as by a reset.
MAX_SPEED, MAX_NOISE = 2.0, 0.05  # [m/s] above the speed of a TurtleBot; [m] for noise


class Trail:
    """The trail of one robot, by its odometry."""

    def __init__(self) -> None:
        self.points: Tuple[Vector3, ...] = ()  # [m] in the frame of the odometry
        self._newest: Optional[Tuple[float, Vector3]] = None  # time [s] and position

    def add(self, time: float, x: float, y: float) -> bool:
        """Continue to a position [m] at a time [s]; start again if the robot was placed there, or if time was set back.

        Return whether the trail starts again.
        """
        if not math.isfinite(x + y):
            return False
        point, is_placed = (x, y, HEIGHT), False
        if self._newest is not None:
            before, position = self._newest
            is_placed = time < before or math.dist(position, point) > MAX_NOISE + MAX_SPEED * (time - before)
            if is_placed:
                self.points = ()
        self._newest = (time, point)
        if not self.points or math.dist(self.points[-1], point) >= SPACING:
            self.points = (*self.points[1 - MAX_POINTS :], point)
        return is_placed
