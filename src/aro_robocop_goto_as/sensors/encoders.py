"""Wheel angles -> what encoders count, ticks and slip included."""

import math
from typing import NamedTuple

import numpy as np

from ..robot import Pair


class Encoders(NamedTuple):
    """What both encoders have counted so far [rad], and the wheel angles [rad] at that time as they really were."""

    counted: Pair
    wheel_angles: Pair


def count(before: Encoders, wheel_angles: Pair, slip: float, noise: np.ndarray) -> Encoders:
    """Encoders of wheels that slip: each counts more than what its wheel rolled, by a random share of it.

    slip: sigma of that share; noise (2,): standard normal, of which the size counts, as slip only ever adds.
    """
    counted = (before.counted[i] + (wheel_angles[i] - before.wheel_angles[i]) * (1.0 + slip * abs(float(noise[i])))
               for i in (0, 1))
    return Encoders((next(counted), next(counted)), wheel_angles)


def ticked(angles: Pair, tick: float) -> Pair:
    """Angles [rad] as whole ticks of so many radians, rounded down."""
    return math.floor(angles[0] / tick) * tick, math.floor(angles[1] / tick) * tick
