"""The edges of occupied cells, against a count cell by cell."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.world.grid_map.reader import edges_of_cells


def edges_one_by_one(occupied):
    """Every cell edge between an occupied and another cell, as a set of ((x, y), (x, y)) in cells."""
    rows, columns = occupied.shape
    found = set()
    for row in range(rows):
        for column in range(columns):
            sides = {
                (0, -1): ((0, 0), (1, 0)),
                (0, 1): ((0, 1), (1, 1)),
                (-1, 0): ((0, 0), (0, 1)),
                (1, 0): ((1, 0), (1, 1)),
            }
            for (dx, dy), (start, end) in sides.items():
                x, y = column + dx, row + dy
                beyond = 0 <= x < columns and 0 <= y < rows and occupied[y, x]
                if occupied[row, column] and not beyond:
                    found.add(((column + start[0], row + start[1]), (column + end[0], row + end[1])))
    return found


@given(st.integers(1, 7), st.integers(1, 7), st.data())
def test_outline_is_all_edges_of_occupied_regions_in_maximal_segments(rows, columns, data):
    occupied = np.array(data.draw(st.lists(st.booleans(), min_size=rows * columns, max_size=rows * columns)))
    occupied = occupied.reshape(rows, columns)
    pieces = []
    segments = edges_of_cells(occupied)
    for (x, y), (x_end, y_end) in segments.astype(int).tolist():
        along = range(x, x_end) if y == y_end else range(y, y_end)
        pieces += [((k, y), (k + 1, y)) if y == y_end else ((x, k), (x, k + 1)) for k in along]
    assert len(pieces) == len(set(pieces)) and set(pieces) == edges_one_by_one(occupied)
    level = [tuple(map(tuple, s.tolist())) for s in segments if s[0, 1] == s[1, 1]]
    assert not {start for start, _ in level} & {end for _, end in level}, "two pieces of one wall"
