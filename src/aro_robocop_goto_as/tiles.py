"""Segments -> those near a place, by a grid of square tiles."""

import math
from typing import List, Tuple

import numpy as np

TILE = 1.0  # [m] a side
FAR = 1e12  # tiles: farther than any world reaches
MOST_TILES = 4096  # of one segment; one that spans more is near everywhere


class Tiles:
    """An index of segments (n, 2, 2) [m], each kept with all tiles that its bounding box meets."""

    def __init__(self, segments: np.ndarray) -> None:
        low = np.floor(segments.min(axis=1) / TILE).astype(np.int64)
        spans = np.floor(segments.max(axis=1) / TILE).astype(np.int64) - low + 1
        small = spans.astype(float).prod(axis=1) <= MOST_TILES
        self._everywhere = np.flatnonzero(~small)
        which, low, spans = np.flatnonzero(small), low[small], spans[small]
        origin = low.min(axis=0) if len(low) else np.zeros(2, dtype=np.int64)
        low = low - origin
        extent = (low + spans).max(axis=0) if len(low) else np.zeros(2, dtype=np.int64)
        counts = spans.prod(axis=1)
        owner = np.repeat(np.arange(len(low)), counts)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
        column = low[owner, 0] + within % spans[owner, 0]
        row = low[owner, 1] + within // spans[owner, 0]
        tile = row * extent[0] + column
        order = np.argsort(tile, kind="stable")
        self._members, self._tiles = which[owner[order]], tile[order]
        self._origin: List[int] = origin.tolist()  # column and row of the lowest tile, counted from the world's origin
        self._extent: List[int] = extent.tolist()  # numbers of columns and rows

    def near(self, x: float, y: float, half: float) -> np.ndarray:
        """Indices of at least the segments that meet the square x +- half, y +- half [m]; some more than once."""
        columns, rows = self._spans(x, y, half)
        if not len(columns):
            return self._everywhere
        return self._between(rows * self._extent[0] + columns[0], rows * self._extent[0] + columns[-1])

    def square(self, x: float, y: float, half: float) -> Tuple[np.ndarray, np.ndarray]:
        """Columns and rows (t,) of the tiles that meet the square x +- half, y +- half [m], as far as there are any."""
        columns, rows = self._spans(x, y, half)
        return np.tile(columns, len(rows)), np.repeat(rows, len(columns))

    def _spans(self, x: float, y: float, half: float) -> List[np.ndarray]:
        """Columns and rows that a square spans."""
        spans = []
        for place, origin, extent in zip((x, y), self._origin, self._extent):
            first = max(math.floor(max((place - half) / TILE, -FAR)) - origin, 0)
            last = min(math.floor(min((place + half) / TILE, FAR)) - origin, extent - 1)
            spans.append(np.arange(first, last + 1))
        return spans

    def members(self, columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Indices of the segments in tiles (t,), and of those that are everywhere."""
        tiles = rows * self._extent[0] + columns
        return self._between(tiles, tiles)

    def _between(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Indices of the segments in ranges of tiles (t,), both ends included, and of those that are everywhere."""
        starts = np.searchsorted(self._tiles, first)
        counts = np.searchsorted(self._tiles, last, "right") - starts
        ends = np.cumsum(counts)
        total = int(ends[-1]) if len(ends) else 0
        within = np.arange(total) + np.repeat(starts - ends + counts, counts)
        return np.concatenate([self._everywhere, self._members[within]])

    def centres(self, columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Centres (t, 2) [m] of tiles."""
        return (np.stack([columns, rows], axis=1) + self._origin + 0.5) * TILE

    def covered_by(self, x: float, y: float, half: float) -> bool:
        """Whether the square x +- half, y +- half [m] holds every tile."""
        return all((place - half) / TILE <= origin and (place + half) / TILE >= origin + extent
                   for place, origin, extent in zip((x, y), self._origin, self._extent))
