"""The clearance ahead of a robot: the nearest obstacle that its scanner sees in the direction of travel."""

import math
from typing import Optional, Sequence

import numpy as np


def beams_ahead(n_beams: int, angle_min: float, increment: float, half_angle: float) -> np.ndarray:
    """Which beams (n_beams,) are within half_angle [rad] of straight ahead."""
    with np.errstate(invalid="ignore", over="ignore"):  # angles that are not numbers do not point ahead
        angles = angle_min + increment * np.arange(n_beams)
        return np.abs(np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi) <= half_angle + 1e-9


def clearance_ahead(
    ranges: Sequence[float], angle_min: float, increment: float, range_min: float, range_max: float, half_angle: float
) -> Optional[float]:
    """Nearest obstacle [m] within half_angle [rad] of straight ahead, in the scanner's frame; +inf for none.

    `ranges` (n_beams,) [m], counter-clockwise from angle_min for a positive increment [rad], clockwise for a negative
    one; 0 to 2 pi as Gazebo's, -pi to pi, or part of a turn. A return counts where range_min < range < range_max, the
    handout's rule. -inf means "too near to measure" (REP-117) and counts as 0. Any other number and +inf mean that
    there is nothing to return the beam: the drivers of the LDS-01 and LDS-02 send 0 where REP-117 asks for +inf. So a
    scanner that sends only zeros can't be told from one in an open space.
    None if no beam points ahead, or if the angles do not tell which beams do: they are NaN or infinite, several beams
    have one direction, or the beams go round more than one and a half times, as angles in degrees would. NaN if no
    beam ahead is valid: all of them are NaN (REP-117), or the range limits are NaN or not in order, so that no return
    could count.
    """
    distances = np.asarray(ranges, dtype=float)
    if len(distances) > 1 and not 0.0 < abs(increment) * (len(distances) - 1) <= 3.0 * math.pi:  # true for NaN
        return None
    ahead = beams_ahead(len(distances), angle_min, increment, half_angle)
    if not ahead.any():
        return None
    distances = distances[ahead]
    if np.isnan(distances).all() or not range_min < range_max:  # also true where a limit is NaN
        return math.nan
    if np.isneginf(distances).any():
        return 0.0
    valid = distances[(distances > range_min) & (distances < range_max)]
    return float(valid.min()) if len(valid) else math.inf
