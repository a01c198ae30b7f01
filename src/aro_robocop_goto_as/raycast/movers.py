"""The moving circles of a cross-section; compiled code puts them where they are at a time."""

import ctypes
from typing import List, Sequence, Tuple

import numpy as np

from ..compiled import address, members
from ..geometry import Pose2D, compose, inverse
from ..world.scripted_motion import Motion
from .caster_library import load


class _MoverStruct(ctypes.Structure):
    """`struct mover` of movers.c."""

    _fields_ = [
        *members(ctypes.c_double, "x y yaw turn at_x at_y"),
        ("n_stops", ctypes.c_int64),
        *members(ctypes.c_void_p, "stops circle"),
    ]


class Movers:
    """Moves the circles of models, as world.scripted_motion.Motion.carry does."""

    def __init__(self, circles: np.ndarray, moving: Sequence[Tuple[int, Motion]]) -> None:
        """circles: (k, [x, y, radius]) [m] at time zero, changed in place; `moving`: row in circles, its motion."""
        at, self._circles = address("circles", circles, (None, 3)), circles
        self._stops: List[np.ndarray] = []
        movers = []
        for row, motion in moving:
            x, y = map(float, circles[row, :2])
            place = compose(inverse(motion.world_from_model), Pose2D(x, y))
            stops = np.array(motion.stops(), dtype=float).reshape(-1, 3)
            self._stops.append(stops)
            movers.append(
                _MoverStruct(
                    *motion.world_from_model,
                    motion.turn,
                    place.x,
                    place.y,
                    len(stops),
                    address("stops", stops, (None, 3)),
                    at + row * circles.strides[0],
                )
            )
        self._structs = (_MoverStruct * len(movers))(*movers)
        self._move = load().aro_move

    def move(self, time: float) -> float:
        """Put the circles where they are at a time of at least 0 [s]; returns the largest distance moved [m]."""
        return float(self._move(self._structs, len(self._structs), time)) if self._structs else 0.0
