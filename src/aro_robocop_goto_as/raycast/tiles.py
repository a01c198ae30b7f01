"""Square tiles that find the segments near a point."""

import math

import numpy as np

from ..compiled import address, structure

TILE = 1.0  # [m] side length, larger in worlds of more than MAX_TILES
MAX_TILES = 1 << 20
MAX_TILES_OF_SEGMENT = 4096  # that one segment is listed in; a longer one counts as near everywhere
PAD = 1e-3  # [m] around each segment: rounding errors never make a beam hit it outside its tiles

_Tiles = structure("raycast/tiles.h", "tiles")


class Tiles:
    """An index of segments (n, 2, 2) [m]: each is listed in all tiles that its bounding box touches."""

    def __init__(self, segments: np.ndarray) -> None:
        low, high = segments.min(axis=1) - PAD, segments.max(axis=1) + PAD
        listed = ((high - low) / TILE + 1.0).prod(axis=1) <= MAX_TILES_OF_SEGMENT
        self._everywhere = np.flatnonzero(~listed).astype(np.int32)
        numbers, low, high = np.flatnonzero(listed), low[listed], high[listed]
        self._origin = low.min(axis=0, initial=np.inf) if len(low) else np.zeros(2)  # [m] lower left corner
        extent = (high - self._origin).max(axis=0, initial=0.0)
        self._side = max(TILE, math.sqrt(float((extent + TILE).prod()) / MAX_TILES))
        self._columns, self._rows = (int(length / self._side) + 1 for length in extent)
        first = ((low - self._origin) / self._side).astype(np.int64)
        spans = ((high - self._origin) / self._side).astype(np.int64) - first + 1
        counts = spans.prod(axis=1)
        owner = np.repeat(np.arange(len(first)), counts)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
        column = first[owner, 0] + within % spans[owner, 0]
        row = first[owner, 1] + within // spans[owner, 0]
        tile = row * self._columns + column
        self._members = numbers[owner[np.argsort(tile, kind="stable")]].astype(np.int32)
        tiles, int32 = self._columns * self._rows, np.int32
        per_tile = np.bincount(tile, minlength=tiles)
        self._starts = np.concatenate([[0], np.cumsum(per_tile)]).astype(int32)
        self._tile_marks = np.zeros(tiles, np.int64)
        self.segment_marks = np.zeros(len(segments), np.int64)  # struct.mark of the last scan that compared the segment
        self.struct = _Tiles(  # created only once: it holds the mark counter
            *self._origin.tolist(),
            self._side,
            self._columns,
            self._rows,
            address("starts", self._starts, (tiles + 1,), int32),
            address("members", self._members, (None,), int32),
            len(self._everywhere),
            address("everywhere", self._everywhere, (None,), int32),
            address("tile_marks", self._tile_marks, (tiles,), np.int64),
            address("segment_marks", self.segment_marks, (None,), np.int64),
            0,
        )
