"""The edges of occupied cells, against a count cell by cell."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.world.grid_map.reader import edges_of_cells


@given(st.integers(1, 7), st.integers(1, 7), st.data())
def test_outline_is_all_edges_of_occupied_regions_in_maximal_segments(rows, columns, data):
    flags = data.draw(st.lists(st.booleans(), min_size=rows * columns, max_size=rows * columns))
    occupied = np.array(flags).reshape(rows, columns)
    segments = [(tuple(start), tuple(end)) for start, end in edges_of_cells(occupied).tolist()]
    for axis in (0, 1):  # a ray from a cell's centre along the axis crosses an odd number of edges: the cell is occupied
        across = [(start, end) for start, end in segments if start[axis] == end[axis]]
        for row, column in np.ndindex(rows, columns):
            cell = (column + 0.5, row + 0.5)
            ahead = [s[axis] > cell[axis] and s[1 - axis] < cell[1 - axis] < e[1 - axis] for s, e in across]
            assert sum(ahead) % 2 == occupied[row, column]
        assert not {start for start, _ in across} & {end for _, end in across}, "two pieces of one wall"
