"""What the scene can draw: shapes with their appearance."""

from dataclasses import dataclass
from typing import Dict, Hashable, Tuple

from ..geometry import Pose3D, Vector3

Color = Tuple[int, int, int]  # red, green, blue from 0 to 255
BOX, CYLINDER, SPHERE, MESH, LINE, TEXT = "box", "cylinder", "sphere", "mesh", "line", "text"


@dataclass(frozen=True)
class Shape:
    """One shape in its own frame.

    size: [m] of a box: x, y, z; of a cylinder: diameter, -, height along z; of a sphere: diameter; of a line: width;
        of text: height
    points: [m] corners of a mesh, three for each triangle; of a line, one after the other
    """

    kind: str
    size: Vector3 = (1.0, 1.0, 1.0)
    color: Color = (200, 200, 200)
    opacity: float = 1.0
    points: Tuple[Vector3, ...] = ()
    text: str = ""


Placed = Tuple[Shape, Pose3D]
Group = Dict[Hashable, Placed]
