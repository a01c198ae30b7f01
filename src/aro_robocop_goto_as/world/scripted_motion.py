"""The scripted motion of a model, as a function of simulated time."""

import bisect
import math
from dataclasses import dataclass
from typing import Callable, Optional, Sequence, Tuple

import numpy as np

from ..geometry import Pose2D, compose, inverse, wrap_angle

Waypoint = Tuple[float, float, float]  # time [s], x, y [m] in the frame of the model at time zero


@dataclass(frozen=True)
class Motion:
    """Planar motion that depends on simulated time only, so it is the same in every run and in both engines.

    world_from_model: the model's pose at time zero
    turn: rate of rotation about the model's origin [rad/s], counter-clockwise
    waypoints: visited at constant speed between each two, starting at (0, 0); the last one ends the cycle there
    """

    world_from_model: Pose2D
    turn: float = 0.0
    waypoints: Tuple[Waypoint, ...] = ()

    def carry(self, pose: Pose2D, time: float) -> Pose2D:
        """The world pose at a time [s] of something fixed to the model that was at `pose` in the world at time zero."""
        x, y = self._shift(time)
        moved = compose(self.world_from_model, Pose2D(x, y, wrap_angle(self.turn * time)))
        return compose(moved, compose(inverse(self.world_from_model), pose))

    def _shift(self, time: float) -> Tuple[float, float]:
        """Displacement of the model's origin since time zero [m], in its frame at time zero."""
        stops = self.stops()
        if not stops:
            return 0.0, 0.0
        time = math.fmod(time, stops[-1][0])
        after = bisect.bisect_right([stop[0] for stop in stops], time)
        (start, x, y), (end, to_x, to_y) = stops[after - 1], stops[after]
        share = (time - start) / (end - start)
        return x + share * (to_x - x), y + share * (to_y - y)

    def stops(self) -> Tuple[Waypoint, ...]:
        """The waypoints with the start; empty for a model that only turns."""
        return ((0.0, 0.0, 0.0), *self.waypoints) if self.waypoints else ()


def moving(circles: np.ndarray, motions: Sequence[Optional[Motion]]) -> Callable[[float], float]:
    """A function that puts circles where their models are at a time [s]; it returns how far [m] one has moved at most.

    circles: (k, [x, y, radius]) [m] at time zero, changed in place; motions: of each, None: it never moves
    """
    starts = [
        (row, motion, Pose2D(*map(float, circles[row, :2]))) for row, motion in enumerate(motions) if motion is not None
    ]

    def move(time: float) -> float:
        farthest = 0.0
        for row, motion, start in starts:
            x, y, _ = motion.carry(start, time)
            farthest = max(farthest, math.hypot(x - circles[row, 0], y - circles[row, 1]))
            circles[row, :2] = x, y
        return farthest

    return move
