"""Fans of beams, and what they may meet, for properties of scans."""

import math

import numpy as np
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.world.load import World


def cut_of(segments: np.ndarray, circles: np.ndarray) -> CrossSection:
    """A cross-section with these segments (m, 2, 2) and circles (k, 3) [m] only."""
    cut = CrossSection(World("w", (), Pose2D(), (), ""), 0.1)
    cut.segments, cut.circles = np.array(segments, float).reshape(-1, 2, 2), np.array(circles, float).reshape(-1, 3)
    return cut


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
