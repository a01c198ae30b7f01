"""Whether a goal is outside the walls around the robot."""

from typing import Iterable, Tuple

import numpy as np

from ..geometry import Pose2D
from ..world.model import Obstacle, World
from .cross_section import CrossSection
from .occupancy import FREE, occupancy_of

HEIGHT = 0.1  # [m] above the floor, at which obstacles are in a robot's way
CELL = 0.05  # [m] narrower openings let nothing pass
MAX_CELLS = 1000  # per side; larger ones beyond it


def is_outside(goal: Tuple[float, float], robot: Tuple[float, float], obstacles: Iterable[Obstacle]) -> bool:
    """Return whether obstacles enclose the robot, and not the goal; both x, y [m]. Never where the world has no walls.

    An open door is no wall: a way leads through it from the robot to the goal, however long this way is.
    """
    section = CrossSection(World("", tuple(obstacles), Pose2D(), (), ""), HEIGHT)
    if not _reached(section, *goal)[0, 0]:
        return False
    within = _reached(section, *robot)  # no cell if an obstacle is in the robot's own, as beside a wall in large cells
    return bool(within.any()) and not within[0, 0]


def _reached(section: CrossSection, x: float, y: float) -> np.ndarray:
    """Whether ways lead from a point to the cells (rows, columns) of a grid; its first cell is beyond all obstacles."""
    return occupancy_of(section.segments, section.circles, [Pose2D(x, y)], CELL, MAX_CELLS).cells == FREE
