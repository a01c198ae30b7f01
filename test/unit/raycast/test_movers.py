"""movers.c against the definition, world.scripted_motion."""

import math
from typing import List, Tuple

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.raycast.movers import moving
from aro_robocop_goto_as.world.scripted_motion import Motion

METRES = st.floats(-5.0, 5.0)
STOPS = st.lists(st.tuples(st.sampled_from([0.1, 1.0, 2.5]), METRES, METRES), max_size=4)


def _motion(pose: Tuple[float, float, float], turn: float, stops: List[Tuple[float, float, float]]) -> Motion:
    ends = np.cumsum([duration for duration, _, _ in stops]).tolist()
    return Motion(Pose2D(*pose), turn, tuple((end, x, y) for end, (_, x, y) in zip(ends, stops)))


MOTION = st.builds(_motion, st.tuples(METRES, METRES, st.floats(-3.0, 3.0)), st.sampled_from([0.0, 0.2, -9.0]), STOPS)


@given(st.lists(st.tuples(METRES, METRES, MOTION), min_size=1, max_size=4), st.lists(st.floats(0.0, 1e4), min_size=1))
def test_circles_are_where_the_motion_says(models: "List[Tuple[float, float, Motion]]", times: "List[float]") -> None:
    standing = [(7.0, 8.0, 0.9)]
    circles = np.array([*standing, *((x, y, 0.1) for x, y, _ in models)])
    move = moving(circles, [None, *(motion for _, _, motion in models)])
    for time in (0.0, *times):
        before = circles.copy()
        farthest = move(time)
        expected = [motion.carry(Pose2D(x, y), time)[:2] for x, y, motion in models]
        np.testing.assert_array_equal(circles[1:, :2], expected)
        assert circles[0].tolist() == list(standing[0]) and (circles[1:, 2] == 0.1).all()
        moved = max(map(math.hypot, *(circles - before)[:, :2].T))
        np.testing.assert_array_max_ulp(farthest, moved, 1)  # the last bit of hypot() differs between Python and C
