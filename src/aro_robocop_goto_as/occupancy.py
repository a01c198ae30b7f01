"""Slice -> the grid map that a perfect mapping run would make of it."""

import math
from typing import Iterator, List

import numpy as np

from .geometry import Pose2D
from .shapes import Occupancy
from .slice import Slice

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
MARGIN = 0.5  # [m] around all that stands there
EDGE = 1e3  # [m] from the start: what ends beyond is the line of an infinite plane, and sets no bounds
CIRCLE_SIDES = 128
MOST_CELLS = 4096  # a side


def occupancy_of(walls: Slice, start: Pose2D, resolution: float) -> Occupancy:
    """Occupied: every cell that an outline touches. Free: every other one that is reached from the start. Else unknown.

    The cells are of `resolution` [m], or coarser where that makes more than MOST_CELLS a side.
    """
    segments = np.concatenate([walls.segments, *(_polygon(circle) for circle in walls.circles)])
    here = np.array([start.x, start.y])
    bounded = segments[np.abs(segments - here).max(axis=(1, 2)) < EDGE].reshape(-1, 2)
    points = np.concatenate([bounded, here[None, :]])
    low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    resolution = max(resolution, float((high - low).max()) / MOST_CELLS)
    columns, rows = (math.ceil(length / resolution) for length in high - low)
    occupied = np.zeros((rows, columns), dtype=bool)
    for cells in _touched((segments - low) / resolution, columns, rows):
        occupied[cells[:, 1], cells[:, 0]] = True
    column, row = np.floor((here - low) / resolution).astype(int)
    free = _reached(~occupied, int(row), int(column))
    cells = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.int8)
    return Occupancy(cells, resolution, Pose2D(float(low[0]), float(low[1])))


def _polygon(circle: np.ndarray) -> np.ndarray:
    """Segments (n, 2, 2) that stand for a circle [x, y, radius]."""
    turns = 2.0 * math.pi * np.arange(CIRCLE_SIDES) / CIRCLE_SIDES
    ring = circle[:2] + circle[2] * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)


def _touched(segments: np.ndarray, columns: int, rows: int) -> Iterator[np.ndarray]:
    """The cells (k, [column, row]) that each segment passes through, in units of cells, as far as they are on the map.

    Between two crossings of the grid's lines there is one cell: the one of the point half way.
    """
    size = np.array([columns, rows])
    for start, end in segments:
        along = end - start
        shares: List[np.ndarray] = [np.array([0.0, 1.0])]
        for axis in (0, 1):
            first, last = sorted((start[axis], end[axis]))
            lines = np.arange(max(math.ceil(first), 0), min(math.floor(last), size[axis]) + 1)
            if along[axis]:
                shares.append((lines - start[axis]) / along[axis])
        crossings = np.unique(np.clip(np.concatenate(shares), 0.0, 1.0))
        cells = np.floor(start + (crossings[:-1, None] + crossings[1:, None]) / 2.0 * along).astype(int)
        yield cells[((cells >= 0) & (cells < size)).all(axis=1)]


def _reached(free: np.ndarray, row: int, column: int) -> np.ndarray:
    """Which free cells are reached from one by steps along rows and columns: run by run, until none is new."""
    reached = np.zeros_like(free)
    reached[row, column] = free[row, column]
    along_rows, along_columns = _runs(free), _runs(free.T).T
    before, now = 0, int(reached.sum())
    while before < now:
        for runs in (along_rows, along_columns):
            hit = np.zeros(free.size + 1, dtype=bool)
            hit[runs[reached]] = True
            reached = hit[runs] & free
        before, now = now, int(reached.sum())
    return reached


def _runs(free: np.ndarray) -> np.ndarray:
    """Numbers (rows, columns) that neighbouring free cells of a row have in common."""
    breaks = ~free
    breaks[:, 0] = True
    return np.cumsum(breaks.ravel()).reshape(free.shape)
