"""Compute the grid map that a perfect mapping run would make of a world's cross-section."""

import math
from typing import Iterator, List, Sequence

import numpy as np

from ..geometry import Pose2D
from ..world.model import Occupancy

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
MARGIN = 0.5  # [m] around all obstacles
BOUNDS_RADIUS = 1e3  # [m] from the first start; a segment that reaches beyond stands for an infinite plane
CIRCLE_SIDES = 128
MAX_CELLS = 4096  # per side


def occupancy_of(
    segments: np.ndarray,
    circles: np.ndarray,
    starts: Sequence[Pose2D],
    resolution: float,
) -> Occupancy:
    """The occupancy grid of outlines: cells they touch are occupied, cells that can be reached from a start are free.

    All other cells are unknown. The first start is in the grid, the others where they are within BOUNDS_RADIUS of it.
    segments: (m, [start, end], [x, y]) [m]; circles: (k, [x, y, radius]) [m]
    resolution: side length of a cell [m]; larger where the grid would have more than MAX_CELLS per side
    """
    segments = np.concatenate([segments, *(_polygon(circle) for circle in circles)])
    seeds = np.array([(start.x, start.y) for start in starts])
    seeds = seeds[np.abs(seeds - seeds[0]).max(axis=1) < BOUNDS_RADIUS]
    bounded = segments[np.abs(segments - seeds[0]).max(axis=(1, 2)) < BOUNDS_RADIUS].reshape(-1, 2)
    points = np.concatenate([bounded, seeds])
    low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    resolution = max(resolution, float((high - low).max()) / MAX_CELLS)
    columns, rows = (math.ceil(length / resolution) for length in high - low)
    occupied = np.zeros((rows, columns), dtype=bool)
    for cells in _touched((segments - low) / resolution, columns, rows):
        occupied[cells[:, 1], cells[:, 0]] = True
    free = _reachable(~occupied, np.floor((seeds - low) / resolution).astype(int))
    cells = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.int8)
    return Occupancy(cells, resolution, Pose2D(float(low[0]), float(low[1])))


def _polygon(circle: np.ndarray) -> np.ndarray:
    """Segments (n, 2, 2) that approximate a circle [x, y, radius]."""
    angles = 2.0 * math.pi * np.arange(CIRCLE_SIDES) / CIRCLE_SIDES
    ring = circle[:2] + circle[2] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)


def _touched(segments: np.ndarray, columns: int, rows: int) -> Iterator[np.ndarray]:
    """The cells (k, [column, row]) of the grid that each segment passes through; segments are in units of cells.

    A segment is split where it crosses the grid lines; each part lies in one cell, found from the part's midpoint.
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


def _reachable(free: np.ndarray, seeds: np.ndarray) -> np.ndarray:
    """The free cells connected to seeds (n, [column, row]) along rows and columns, filling whole runs at a time."""
    reached = np.zeros_like(free)
    reached[seeds[:, 1], seeds[:, 0]] = free[seeds[:, 1], seeds[:, 0]]
    row_runs, column_runs = _run_numbers(free), _run_numbers(free.T).T
    before, now = 0, int(reached.sum())
    while before < now:
        for runs in (row_runs, column_runs):
            hit = np.zeros(free.size + 1, dtype=bool)
            hit[runs[reached]] = True
            reached = hit[runs] & free
        before, now = now, int(reached.sum())
    return reached


def _run_numbers(free: np.ndarray) -> np.ndarray:
    """A number per cell (rows, columns); neighbouring free cells of one row have the same number."""
    breaks = ~free
    breaks[:, 0] = True
    return np.cumsum(breaks.ravel()).reshape(free.shape)
