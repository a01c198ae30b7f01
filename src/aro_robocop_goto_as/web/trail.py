"""Where a robot has been: a polyline with a limited number of points."""

import math
from collections import deque
from typing import Deque, Tuple

import numpy as np

SPACING = 0.05  # [m] between two points
JUMP = 1.0  # [m] between two poses; beyond it the robot was placed there, and the trail starts again
LONGEST = 600  # points, 30 m


class Trail:
    """The last points of a path, in the frame in which they are given."""

    def __init__(self, longest: int = LONGEST) -> None:
        self._points: Deque[Tuple[float, float]] = deque(maxlen=longest)

    def add(self, x: float, y: float) -> bool:
        """Take a position [m]; returns whether the trail has changed."""
        if self._points:
            distance = math.hypot(x - self._points[-1][0], y - self._points[-1][1])
            if distance < SPACING:
                return False
            if distance > JUMP:
                self._points.clear()
        self._points.append((x, y))
        return True

    def clear(self) -> None:
        """Forget all points."""
        self._points.clear()

    def segments(self, height: float) -> np.ndarray:
        """Pairs of points (n, 2, 3) [m] at this height; n is 0 for fewer than two points."""
        points = np.array([(x, y, height) for x, y in self._points], dtype=np.float32).reshape(-1, 3)
        return np.stack([points[:-1], points[1:]], axis=1) if len(points) > 1 else np.zeros((0, 2, 3), np.float32)
