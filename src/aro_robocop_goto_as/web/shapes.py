"""What the scene can draw: shapes with their appearance."""

from dataclasses import dataclass, field
from typing import Dict, Hashable, Optional, Tuple

import numpy as np

from ..geometry import Pose3D, Vector3

Color = Tuple[int, int, int]  # red, green, blue from 0 to 255
BOX, CYLINDER, SPHERE, MESH, LINE, TEXT = "box", "cylinder", "sphere", "mesh", "line", "text"
POINTS, IMAGE, FRAME, BODY = "points", "image", "frame", "body"


@dataclass(frozen=True)
class Shape:
    """One shape in its own frame.

    size: [m] of a box: x, y, z; of a cylinder: diameter, -, height along z; of a sphere and of points: diameter; of a
        line: width; of text: height; of an image: width, height
    points: [m] corners of a mesh, three for each triangle; of a line, one after the other; of points
    text: that is shown, or the name beside a frame's axes
    parts: of a body: shapes with their poses in its frame
    image: (rows, columns, 4), row 0 at the lowest y; not compared, so another image needs another key in its group
    """

    kind: str
    size: Vector3 = (1.0, 1.0, 1.0)
    color: Color = (200, 200, 200)
    opacity: float = 1.0
    points: Tuple[Vector3, ...] = ()
    text: str = ""
    parts: "Tuple[Placed, ...]" = ()
    image: Optional[np.ndarray] = field(default=None, compare=False)


Placed = Tuple[Shape, Pose3D]
Group = Dict[Hashable, Placed]
