"""The moving circles of a cross-section; compiled code puts them where they are at a time."""

import ctypes
from typing import Callable, List, Optional, Sequence

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


def moving(circles: np.ndarray, motions: Sequence[Optional[Motion]]) -> Callable[[float], float]:
    """A function that moves circles of models, as world.scripted_motion.Motion.carry does.

    circles: (k, [x, y, radius]) [m] at time zero, changed in place; motions: of each, None: it never moves
    The function puts the circles where they are at a time of at least 0 [s]; it returns the largest distance moved [m].
    """
    at = address("circles", circles, (None, 3))
    stops: List[np.ndarray] = []
    movers: List[_MoverStruct] = []
    for row, motion in enumerate(motions):
        if motion is not None:
            x, y = map(float, circles[row, :2])
            place = compose(inverse(motion.world_from_model), Pose2D(x, y))
            stops.append(np.array(motion.stops(), dtype=float).reshape(-1, 3))
            fields = (*motion.world_from_model, motion.turn, place.x, place.y, len(stops[-1]))
            movers.append(_MoverStruct(*fields, address("stops", stops[-1], (None, 3)), at + row * circles.strides[0]))
    structs, move_all = (_MoverStruct * len(movers))(*movers), load().aro_move

    def move(time: float, _pointed_to: object = (circles, stops)) -> float:  # which the structures do not keep alive
        return float(move_all(structs, len(structs), time)) if structs else 0.0

    return move
