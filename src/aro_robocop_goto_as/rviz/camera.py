"""The part of the world that RViz shows -> where its camera stands."""

import math
from dataclasses import dataclass, replace
from typing import Tuple

import numpy as np

YAW, PITCH = 1.5 * math.pi, 1.05  # [rad] x points to the right, y up the screen, seen steeply from above
FIELD_OF_VIEW = math.radians(45.0)  # [rad] vertical, of every RViz camera: Ogre's default
MARGIN = 1.04  # of the distance, so that nothing touches the edges
HIGHEST = 1.0  # [m] what is higher than this may reach out of the view


@dataclass(frozen=True)
class Extent:
    """A part of the world: from low to high, each x, y [m], and its height above the floor [m]."""

    low: Tuple[float, float] = (-2.5, -2.5)
    high: Tuple[float, float] = (2.5, 2.5)
    height: float = 0.5

    def with_point(self, x: float, y: float, margin: float) -> "Extent":
        """Extended to a point [m] with a margin [m] around it."""
        low = (min(self.low[0], x - margin), min(self.low[1], y - margin))
        high = (max(self.high[0], x + margin), max(self.high[1], y + margin))
        return replace(self, low=low, high=high)

    def limited(self, side: float, x: float, y: float) -> "Extent":
        """At most `side` [m] in x and y; of what is longer, the part around the point [m], as far as there is any."""
        x_low, x_high = _limited(self.low[0], self.high[0], side, x)
        y_low, y_high = _limited(self.low[1], self.high[1], side, y)
        return replace(self, low=(x_low, y_low), high=(x_high, y_high))


def _limited(low: float, high: float, side: float, around: float) -> Tuple[float, float]:
    if high - low <= side:
        return low, high
    start = min(max(around - side / 2.0, low), high - side)
    return start, start + side


@dataclass(frozen=True)
class Orbit:
    """RViz's orbit camera: it looks from a distance [m], at PITCH and YAW, at the focal point x, y [m] on the floor."""

    distance: float
    x: float
    y: float


def fitting(extent: Extent, aspect: float) -> Orbit:
    """The camera nearest to an extent that shows all of it in a view of this width / height.

    A point p relative to the focal point is visible if |up . p| <= tan(FIELD_OF_VIEW / 2) (distance + ahead . p), with
    the camera's axes up and ahead; in width likewise, times `aspect`. The focal point is where the upper and the lower
    edge demand the same distance.
    """
    slope = math.tan(FIELD_OF_VIEW / 2.0)
    sine, cosine = math.sin(PITCH), math.cos(PITCH)
    (x_low, y_low), (x_high, y_high) = extent.low, extent.high
    half_width, half_depth = (x_high - x_low) / 2.0, (y_high - y_low) / 2.0
    y, z = (grid.ravel() for grid in np.meshgrid([-half_depth, half_depth], [0.0, min(extent.height, HIGHEST)]))
    up, ahead = y * sine + z * cosine, y * cosine - z * sine
    upper, lower = float((up / slope - ahead).max()), float((-up / slope - ahead).max())
    shift = (upper - lower) * slope / (2.0 * sine)
    wide = half_width / (slope * aspect) - float(ahead.min())
    distance = max((upper + lower) / 2.0, wide) + shift * cosine
    return Orbit(MARGIN * distance, (x_low + x_high) / 2.0, (y_low + y_high) / 2.0 + shift)
