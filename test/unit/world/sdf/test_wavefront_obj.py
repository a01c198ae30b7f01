"""Vertices and faces of .obj files."""

import numpy as np
import pytest
from sdf_files import mesh_world, only_obstacle

CORNERS = b"v 0 0 0\nv 1 0 0\nv 0 0 1\n"


A, B, C = (0, 0, 0), (1, 0, 0), (0, 0, 1)


@pytest.mark.parametrize(
    ("rest", "expected"),
    [
        (b"f 1 2 3", [(A, B, C)]),
        (b"f 3/9/9 2//9 1/9  # a comment\r\nvt 0\nl 1 2\n\xff", [(C, B, A)]),
        (b"f 1 \\\n2 3\n", [(A, B, C)]),
        (b"\tv\t1\t0\t1\n  f\t1 2 4  # \xe9", [(A, B, (1, 0, 1))]),
        (b"v 1 0 1 0.5 0.5 0.5\nf 1 2 4 3", [(A, B, (1, 0, 1)), (A, (1, 0, 1), C)]),
        (b"f -3 -2 -1\nv 5 0 0\nf -4 -3 -1\nf 1 2 5\nv 6 0 0", [(A, B, C), (A, B, (5, 0, 0)), (A, B, (6, 0, 0))]),
    ],
)
def test_only_vertices_and_faces_of_an_obj_are_read(tmp_path, rest, expected):
    (tmp_path / "m.obj").write_bytes(CORNERS + rest)
    assert only_obstacle(mesh_world(tmp_path, "m.obj")).geometry.corners.tolist() == np.array(expected).tolist()
