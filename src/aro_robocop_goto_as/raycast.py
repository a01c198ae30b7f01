"""Slice + poses -> exact distances along a fan of evenly spread beams, for any number of scanners at once.

Each segment or circle is tried only against the beams that can meet it: those between the bearings of its two ends.
That is a thousand or so pairs for 360 beams in a room, all of them worked on as flat arrays.
"""

import math
from dataclasses import dataclass
from typing import List, Optional, Tuple

import numpy as np

from .slice import Slice
from .tiles import TILE, Tiles

TURN = 2.0 * math.pi
AT_ONCE = 1500  # segments: as many are faster tried all than chosen from (measured)
NEAR = 2.5  # [m] half the side of the first square in which many segments are looked up
FARTHER = 4.0  # times as far goes the next one
HALF_DIAGONAL = TILE * math.sqrt(0.5)  # [m] of a tile
TOLERANCE = 1e-9  # [rad] beams this close to an end meet it, so that none slips through between two walls at a corner


@dataclass(frozen=True)
class _Pairs:
    """Which beam meets which shape: flat arrays of the same length, with the distance [m]."""

    beam: np.ndarray  # index into all beams of all scanners
    distance: np.ndarray


class Fan:
    """Beams at angle_min + i * increment [rad], i from 0 to samples - 1, counter-clockwise in the scanner's frame."""

    def __init__(self, angle_min: float, increment: float, samples: int) -> None:
        if not (increment > 0.0 and samples >= 1):
            raise ValueError(f"expected increment > 0 and samples >= 1, got {increment} and {samples}")
        self.angle_min = angle_min
        self.increment = increment
        self.samples = samples
        angles = angle_min + increment * np.arange(samples)
        self._dx, self._dy = np.cos(angles), np.sin(angles)
        turns = math.floor((samples - 1) * increment / TURN + TOLERANCE)
        self._shifts = TURN * np.arange(-1, turns + 1)[:, None]  # an interval of bearings may meet the fan once a turn

    def cast(self, world_from_scans: np.ndarray, walls: Slice, others: Optional[np.ndarray] = None,
             reach: float = math.inf) -> np.ndarray:
        """Distances (r, samples) [m] from poses (r, 3) [x m, y m, yaw rad]; +inf where nothing is met within `reach`.

        `others` (r, k, 3) are circles [x m, y m, radius m] that only the scanner of that row sees, such as the other
        robots. From inside a circle its far side is met; a segment is met from both sides.
        """
        found: List[_Pairs] = []
        if len(walls.segments) and walls.tiles is None:
            found.append(self._to_segments(world_from_scans, walls.segments))
        if len(walls.circles):
            found.append(self._to_circles(_in_scans(world_from_scans, walls.circles[:, :2]), walls.circles[:, 2]))
        if others is not None and others.size:
            found.append(self._to_circles(_in_scans(world_from_scans, others[..., :2]), others[..., 2]))
        distances = self._nearest(found, len(world_from_scans))
        if walls.tiles is not None:
            for pose, nearest in zip(world_from_scans, distances):
                self._approach(pose, walls.segments, walls.tiles, nearest, reach)
        distances[distances > reach] = np.inf
        return distances

    def _approach(self, pose: np.ndarray, segments: np.ndarray, tiles: Tiles, nearest: np.ndarray,
                  reach: float) -> None:
        """Lower distances (samples,) to those of segments, out of many: all within reach, where these are few enough.

        Else it looks at squares about the scanner, ever bigger.

        What a beam meets within its square is final, as all segments have been tried that it can meet there. So the
        next square is looked at only where beams go on that have met nothing yet.
        """
        x, y = float(pose[0]), float(pose[1])
        half, found = reach, tiles.near(x, y, reach)
        if len(found) > AT_ONCE:
            half = min(NEAR, reach)
            found = tiles.near(x, y, half)
        going_on: Optional[np.ndarray] = None
        while True:
            if len(found):
                pairs = self._to_segments(pose[None, :], segments[found], going_on)
                np.minimum(nearest, self._nearest([pairs], 1)[0], out=nearest)
            going_on = nearest > half
            if half >= reach or not going_on.any() or tiles.covered_by(x, y, half):
                return
            half = min(FARTHER * half, reach)
            columns, rows = tiles.square(x, y, half)
            ahead = self._meets(going_on, _in_scans(pose[None, :], tiles.centres(columns, rows))[0])
            found = np.unique(tiles.members(columns[ahead], rows[ahead]))

    def _meets(self, beams: np.ndarray, centres: np.ndarray) -> np.ndarray:
        """Which tiles, by their centres (t, 2) in the scanner's frame, any of the marked beams (samples,) may meet."""
        away = np.hypot(centres[:, 0], centres[:, 1])
        half = np.arcsin(np.minimum(HALF_DIAGONAL / np.maximum(away, HALF_DIAGONAL), 1.0))
        half[away <= HALF_DIAGONAL] = math.pi
        first, last = self._between(_bearing(centres) - half, 2.0 * half, beams)
        return (last >= first).any(axis=0)

    def _nearest(self, found: List[_Pairs], scanners: int) -> np.ndarray:
        """The smallest distance of each beam: pairs sorted by beam, then one minimum a run."""
        distances = np.full(scanners * self.samples, np.inf)
        if found:
            beam = np.concatenate([pairs.beam for pairs in found])
            if len(beam):
                small = beam.astype(np.uint16) if len(distances) <= 65536 else beam  # 16 bits are sorted by radix
                order = np.argsort(small, kind="stable")
                sorted_beam = beam[order]
                first = np.flatnonzero(np.diff(sorted_beam, prepend=-1))
                nearest = np.minimum.reduceat(np.concatenate([pairs.distance for pairs in found])[order], first)
                distances[sorted_beam[first]] = nearest
        return distances.reshape(scanners, self.samples)

    def _expand(self, low: np.ndarray, span: np.ndarray,
                beams: Optional[np.ndarray] = None) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Beams within bearings low .. low + span [rad], (r, m) each: flat indices of shape, scanner's beam, beam.

        Of marked beams (samples,) only, if these are given.
        """
        first, last = self._between(low.ravel(), span.ravel(), beams)
        counts = np.maximum(last - first + 1, 0).ravel()
        which = np.repeat(np.arange(counts.size), counts)
        within = np.arange(which.size) - np.repeat(np.cumsum(counts) - counts, counts)
        beam = first.ravel()[which] + within
        if beams is not None:
            beam = np.flatnonzero(beams)[beam]
        shape = which % low.size
        return shape, beam, beam + self.samples * (shape // low.shape[1])

    def _between(self, low: np.ndarray, span: np.ndarray,
                 beams: Optional[np.ndarray] = None) -> Tuple[np.ndarray, np.ndarray]:
        """First and last beam within bearings low .. low + span (m,) [rad], (turns, m) each; last < first for none.

        With marked beams (samples,), these alone are counted.
        """
        start = np.mod(low - self.angle_min, TURN) + self._shifts
        first = np.maximum(np.ceil((start - TOLERANCE) / self.increment), 0.0)
        last = np.minimum(np.floor((start + span + TOLERANCE) / self.increment), self.samples - 1.0)
        whole_first, whole_last = (np.clip(ends, -1.0, self.samples).astype(np.intp) for ends in (first, last))
        if beams is None:
            return whole_first, whole_last
        before = np.concatenate([[0], np.cumsum(beams)])  # marked beams below each beam
        return before[whole_first], before[whole_last + 1] - 1

    def _to_segments(self, poses: np.ndarray, segments: np.ndarray, beams: Optional[np.ndarray] = None) -> _Pairs:
        starts, ends = _in_scans(poses, segments[:, 0]), _in_scans(poses, segments[:, 1])
        from_bearing, to_bearing = _bearing(starts), _bearing(ends)
        sweep = np.mod(to_bearing - from_bearing + math.pi, TURN) - math.pi
        shape, beam, flat = self._expand(np.where(sweep >= 0.0, from_bearing, to_bearing), np.abs(sweep), beams)
        along = ends - starts
        ahead = (starts[..., 0] * along[..., 1] - starts[..., 1] * along[..., 0]).ravel()
        across = self._dx[beam] * along[..., 1].ravel()[shape] - self._dy[beam] * along[..., 0].ravel()[shape]
        farthest = np.sqrt(np.maximum((starts ** 2).sum(axis=-1), (ends ** 2).sum(axis=-1))).ravel()
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = ahead[shape] / across
        # Along a segment seen edge-on both terms vanish: it is no farther than its farther end.
        distance = np.where(distance >= 0.0, np.minimum(distance, farthest[shape]), np.inf)
        return _Pairs(flat, distance)

    def _to_circles(self, centres: np.ndarray, radii: np.ndarray) -> _Pairs:
        """Centres (r, k, 2) in each scanner's frame, radii (k,) or (r, k)."""
        away = np.hypot(centres[..., 0], centres[..., 1])
        inside = away <= radii
        with np.errstate(divide="ignore", invalid="ignore"):
            half = np.where(inside, math.pi, np.arcsin(np.minimum(radii / away, 1.0)))
        shape, beam, flat = self._expand(_bearing(centres) - half, 2.0 * half)
        along = self._dx[beam] * centres[..., 0].ravel()[shape] + self._dy[beam] * centres[..., 1].ravel()[shape]
        free = (away ** 2 - radii ** 2).ravel()[shape]
        half_chord = np.sqrt(np.maximum(along * along - free, 0.0))
        return _Pairs(flat, along + np.where(inside.ravel()[shape], half_chord, -half_chord))


def _in_scans(poses: np.ndarray, points: np.ndarray) -> np.ndarray:
    """World points (m, 2), or (r, m, 2) a set for each, seen from poses (r, 3): (r, m, 2)."""
    # A copy: of a column, NumPy's vectorised cosine takes another way, other in the last bits, when by its too careful
    # reckoning the result's memory overlaps the column's. So the same run would not always give the same bytes.
    yaw = poses[:, 2].copy()
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    dx, dy = points[..., 0] - poses[:, 0:1], points[..., 1] - poses[:, 1:2]
    return np.stack([c * dx + s * dy, c * dy - s * dx], axis=-1)


def _bearing(points: np.ndarray) -> np.ndarray:
    return np.arctan2(points[..., 1], points[..., 0])
