"""Simulated time -> where a model that moves by script is."""

import bisect
import math
from dataclasses import dataclass
from typing import Tuple

from .geometry import Pose2D, compose, inverse, wrap_angle

Waypoint = Tuple[float, float, float]  # time [s], x, y [m] in the frame of the model at time zero


@dataclass(frozen=True)
class Motion:
    """A motion on the plane that is a function of simulated time alone, so the same in every run and in both drives.

    world_from_model: the model's pose at time zero
    turn: how fast the model turns about its own origin [rad/s], counter-clockwise
    waypoints: through which it goes at even speed from one to the next, from (0, 0) back to there, over and over
    """

    world_from_model: Pose2D
    turn: float = 0.0
    waypoints: Tuple[Waypoint, ...] = ()

    def carry(self, pose: Pose2D, time: float) -> Pose2D:
        """Where something is at a time [s] that belongs to the model and was at a pose in the world at time zero."""
        x, y = self._shift(time)
        moved = compose(self.world_from_model, Pose2D(x, y, wrap_angle(self.turn * time)))
        return compose(moved, compose(inverse(self.world_from_model), pose))

    def _shift(self, time: float) -> Tuple[float, float]:
        """How far the model's origin is from where it was at time zero [m], in its frame of then."""
        if not self.waypoints:
            return 0.0, 0.0
        stops = ((0.0, 0.0, 0.0), *self.waypoints)
        time = math.fmod(time, stops[-1][0])
        after = bisect.bisect_right([stop[0] for stop in stops], time)
        (start, x, y), (end, to_x, to_y) = stops[after - 1], stops[after]
        share = (time - start) / (end - start)
        return x + share * (to_x - x), y + share * (to_y - y)
