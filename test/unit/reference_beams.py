"""A reference definition of a scan that shares no formula with the compiled caster, and scenes to compare both in."""

import math
from typing import Tuple

import numpy as np
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.world.load import World

MARGIN = 1e-7  # [rad] a beam this close to the edge of a shape may hit or miss it
CLOSE = 1e-7  # [m] from a scanner this close to a shape, a beam may hit or miss it


def cut_of(segments: np.ndarray, circles: np.ndarray) -> CrossSection:
    """A cross-section with these segments (m, 2, 2) and circles (k, 3) [m] only."""
    cut = CrossSection(World("w", (), Pose2D(), (), ""), 0.1)
    cut.segments, cut.circles = np.array(segments, float).reshape(-1, 2, 2), np.array(circles, float).reshape(-1, 3)
    return cut


def bounds(cut: CrossSection, x: float, y: float, angle: float) -> Tuple[float, float]:
    """The smallest and largest distance [m] that a beam from a point at a world angle [rad] may measure.

    Shapes are rotated so that the beam points along the x axis. The two differ where the beam only grazes a shape.
    """
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    least = greatest = math.inf
    for ends in (cut.segments - [x, y]) @ turn.T:
        low, high = _of_segment(ends)
        least, greatest = min(least, low), min(greatest, high)
    for (cx, cy), radius in zip((cut.circles[:, :2] - [x, y]) @ turn.T, cut.circles[:, 2]):
        low, high = _of_circle(cx, cy, radius)
        least, greatest = min(least, low), min(greatest, high)
    return least, greatest


def _of_segment(ends: np.ndarray) -> Tuple[float, float]:
    if (ends[0] == ends[1]).all():
        return math.inf, math.inf
    distances = np.hypot(ends[:, 0], ends[:, 1])
    off = [MARGIN * away + CLOSE**2 for away in distances]  # [m] from the beam, still within the margin
    nearest = _to_segment(ends)
    (ax, ay), (bx, by) = ends.tolist()
    if nearest < CLOSE:
        return 0.0, math.inf
    if (ay > off[0] and by < -off[1]) or (ay < -off[0] and by > off[1]):
        crossing = ax - ay * (bx - ax) / (by - ay)
        return (crossing, crossing) if crossing > 0.0 else (math.inf, math.inf)
    if (ay > off[0] and by > off[1]) or (ay < -off[0] and by < -off[1]):
        return math.inf, math.inf
    return (nearest, math.inf) if max(ax, bx) > 0.0 else (math.inf, math.inf)


def _to_segment(ends: np.ndarray) -> float:
    along = ends[1] - ends[0]
    share = min(max(-float(ends[0] @ along) / float(along @ along), 0.0), 1.0)
    return float(np.hypot(*(ends[0] + share * along)))


def _of_circle(cx: float, cy: float, radius: float) -> Tuple[float, float]:
    away = math.hypot(cx, cy)
    if abs(away - radius) < CLOSE:  # on the outline: rounding decides on which side
        return 0.0, math.inf
    if abs(abs(cy) - radius) < MARGIN * away and away > radius:
        return (math.sqrt(away**2 - radius**2) - math.sqrt(2.0 * radius * MARGIN * away), math.inf)
    if abs(cy) > radius or (away > radius and cx < 0.0):
        return math.inf, math.inf
    half_chord = math.sqrt(radius**2 - cy**2)
    distance = cx + half_chord if away < radius else cx - half_chord
    return distance, distance


# On a lattice many things coincide: corners with beams and tile borders, scanners with walls, ends with ends.
lattice = st.integers(-12, 12).map(lambda n: n / 4.0)
coordinates = st.one_of(lattice, st.floats(-3.0, 3.0))
points = st.tuples(coordinates, coordinates)
segments = st.lists(st.tuples(points, points), max_size=8)
circles = st.lists(
    st.tuples(coordinates, coordinates, st.one_of(st.sampled_from([0.25, 1.0, 2.0]), st.floats(0.01, 4.0))), max_size=4
)
cuts = st.builds(cut_of, segments, circles)
yaws = st.one_of(st.integers(-8, 8).map(lambda n: n * math.pi / 4.0), st.floats(-10.0, 10.0))
poses = st.tuples(coordinates, coordinates, yaws)
spans = st.one_of(st.sampled_from([2.0 * math.pi, 6.28319, math.pi, 4.0 * math.pi]), st.floats(0.01, 15.0))
starts = st.one_of(st.sampled_from([0.0, -math.pi, math.pi, -math.pi / 2.0]), st.floats(-10.0, 10.0))
fans = st.builds(lambda start, span, n: Fan(start, span / max(n - 1, 1), n), starts, spans, st.integers(1, 90))
