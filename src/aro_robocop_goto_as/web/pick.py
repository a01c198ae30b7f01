"""A click on the page -> the point of the floor below the pointer."""

import math
from typing import Optional, Tuple

from ..geometry import Vector3

FARTHEST_CLICK = 1000.0  # [m] from the scene's origin; a ray that almost misses the floor meets it somewhere beyond


def floor_point(origin: Vector3, direction: Vector3) -> Optional[Tuple[float, float]]:
    """Where a ray meets the plane z = 0: x, y [m], or None if it does not, or too far away to be meant."""
    numbers = (*origin, *direction)
    if not all(math.isfinite(number) for number in numbers) or direction[2] * origin[2] >= 0.0:
        return None
    distance = -origin[2] / direction[2]
    x, y = origin[0] + distance * direction[0], origin[1] + distance * direction[1]
    return (x, y) if math.hypot(x, y) <= FARTHEST_CLICK else None
