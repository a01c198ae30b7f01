"""What wheel encoders count, with slip and a finite resolution."""

import math
from typing import NamedTuple

import numpy as np

from ..robot.model import Pair


class Encoders(NamedTuple):
    """The angles that both encoders have counted [rad], and the true wheel angles at that time [rad]."""

    counted: Pair
    wheel_angles: Pair


def count(before: Encoders, wheel_angles: Pair, slip: float, noise: np.ndarray) -> Encoders:
    """Advance both encoders of slipping wheels: each counts more than its wheel has rolled, by a random fraction.

    slip: standard deviation of that fraction; noise: (2,) standard normal, its magnitude is used, as slip only adds.
    """
    counted = (
        before.counted[i] + (wheel_angles[i] - before.wheel_angles[i]) * (1.0 + slip * abs(float(noise[i])))
        for i in (0, 1)
    )
    return Encoders((next(counted), next(counted)), wheel_angles)


def ticked(angles: Pair, tick: float) -> Pair:
    """Angles [rad] rounded down to whole ticks [rad]."""
    return math.floor(angles[0] / tick) * tick, math.floor(angles[1] / tick) * tick
