"""The walls of a map: the edges of its occupied cells."""

import numpy as np


def edges_of_cells(occupied: np.ndarray) -> np.ndarray:
    """The edges between occupied and other cells, merged into segments (n, [start, end], [x, y]) in units of cells.

    occupied: (rows, columns) bool; the outside of the map counts as not occupied.
    """
    rows, columns = occupied.shape
    framed = np.zeros((rows + 2, columns + 2), dtype=bool)
    framed[1:-1, 1:-1] = occupied
    along_x = _runs(framed[1:, 1:-1] != framed[:-1, 1:-1])
    along_y = _runs((framed[1:-1, 1:] != framed[1:-1, :-1]).T)
    return np.concatenate([along_x[..., ::-1], along_y]).astype(float)


def _runs(edges: np.ndarray) -> np.ndarray:
    """Runs of true values in each row of (m, n): (k, [start, end], [row, column])."""
    rows, length = edges.shape
    framed = np.zeros((rows, length + 2), dtype=bool)
    framed[:, 1:-1] = edges
    turns = np.flatnonzero(framed[:, 1:] != framed[:, :-1])
    return np.stack([turns // (length + 1), turns % (length + 1)], axis=-1).reshape(-1, 2, 2)
