"""The page's 3D scene: groups of shapes, drawn by viser."""

from dataclasses import dataclass, field, replace
from typing import Any, Dict, Hashable, Iterable, Optional, Tuple

import numpy as np

from ..geometry import Pose3D, Vector3

Color = Tuple[int, int, int]  # red, green, blue from 0 to 255
BOX, CYLINDER, SPHERE, MESH, LINE, TEXT = "box", "cylinder", "icosphere", "mesh_simple", "line_segments", "label"
POINTS, IMAGE, BODY = "point_cloud", "image", "body"
MIN_CHANGE = 1e-4  # [m] and quaternion units: smaller changes of a pose are not sent
LOOK = ("color", "opacity")
CHANGEABLE = {  # what may differ between two shapes of a kind without drawing anew
    **dict.fromkeys((BOX, CYLINDER, SPHERE, MESH), LOOK),
    TEXT: ("text", *LOOK),
    LINE: ("points", *LOOK),
    POINTS: ("points",),
}
FLAT = {"cast_shadow": False, "receive_shadow": False}


@dataclass(frozen=True)
class Visual:
    """One shape in its own frame, with its looks.

    size: [m] of a box: x, y, z; of a cylinder: diameter, -, height along z; of a sphere and of points: diameter; of a
        line: width; of text: height; of an image: width, height
    points: [m] corners of a mesh, three for each triangle; of a line, one after the other; of points
    parts: of a body: shapes with their poses in its frame
    image: (rows, columns, 4), row 0 at the lowest y; not compared, so another image needs another key in its group
    """

    kind: str  # as in the name of viser's add_KIND, except for BODY
    size: Vector3 = (1.0, 1.0, 1.0)
    color: Color = (200, 200, 200)
    opacity: float = 1.0
    points: Tuple[Vector3, ...] = ()
    text: str = ""
    parts: "Tuple[PlacedVisual, ...]" = ()
    image: Optional[np.ndarray] = field(default=None, compare=False)


PlacedVisual = Tuple[Visual, Pose3D]
Group = Dict[Hashable, PlacedVisual]


def color_of(rgba: Iterable[float]) -> Tuple[Color, float]:
    """Colour and opacity of a shape for red, green, blue and opacity from 0 to 1; ValueError if it is not four."""
    red, green, blue, opacity = (min(max(value, 0.0), 1.0) for value in rgba)
    return (round(255 * red), round(255 * green), round(255 * blue)), opacity


def _wxyz(pose: Pose3D) -> Tuple[float, float, float, float]:
    x, y, z, w = pose.orientation
    return (w, x, y, z)


def _options(shape: Visual) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """viser's arguments for a shape: those that are fixed once it is drawn, and those that can be set later on."""
    kind, (x, y, z), points = shape.kind, shape.size, np.array(shape.points, dtype=np.float32)
    look = {"color": shape.color, "opacity": shape.opacity if shape.opacity < 1.0 else None}
    if kind == BOX:
        return {**FLAT, "dimensions": shape.size}, look
    if kind == CYLINDER:
        return {**FLAT, "radius": x / 2.0, "height": z}, look
    if kind == SPHERE:
        return {**FLAT, "radius": x / 2.0}, look
    if kind == MESH:
        faces = np.arange(len(points), dtype=np.uint32).reshape(-1, 3)
        return {**FLAT, "vertices": points, "faces": faces, "side": "double", "flat_shading": True}, look
    if kind == LINE:
        segments = np.stack([points[:-1], points[1:]], axis=1)
        return {"thickness": x}, {"points": segments, "colors": np.array(shape.color, dtype=np.uint8)}
    if kind == POINTS:
        style = {"colors": shape.color, "point_size": x, "point_shape": "circle", "precision": "float32"}
        return style, {"points": points}
    if kind == TEXT:
        return {"anchor": "bottom-center"}, {"text": shape.text}
    if kind == IMAGE:
        return {**FLAT, "image": shape.image, "render_width": x, "render_height": y}, {}
    raise ValueError(f"no shape of the kind {kind!r}")


@dataclass
class _SceneNode:
    """A shape in the scene, with the handle of viser, and the shape and the pose that were sent last."""

    handle: Any
    shape: Visual
    pose: Pose3D

    def move(self, pose: Pose3D) -> None:
        new, old = (*pose.position, *pose.orientation), (*self.pose.position, *self.pose.orientation)
        if any(abs(a - b) > MIN_CHANGE for a, b in zip(new, old)):
            self.handle.position, self.handle.wxyz = pose.position, _wxyz(pose)
            self.pose = pose

    def restyle(self, new: Visual) -> bool:
        """Change what can be changed in place; False if the shape has to be drawn anew."""
        old, self.shape = self.shape, new
        if old == new:
            return True
        kept = {name: getattr(new, name) for name in CHANGEABLE.get(new.kind, ())}
        if not kept or replace(old, **kept) != new:
            return False
        for name, value in _options(new)[1].items():
            setattr(self.handle, name, value)
        return True


class PageScene:
    """The scene that all browsers show. `api` is the scene of a viser server; only one thread may call the methods."""

    def __init__(self, api: Any) -> None:
        self._api = api
        self._groups: Dict[str, Dict[Hashable, _SceneNode]] = {}
        self._count = 0

    def show(self, group: str, shapes: Group) -> None:
        """Show these shapes, and none that the group held before and does not hold now; poses in the fixed frame."""
        drawn = self._groups.setdefault(group, {})
        for key in [key for key in drawn if key not in shapes]:
            drawn.pop(key).handle.remove()
        for key, (shape, pose) in shapes.items():
            if key in drawn and drawn[key].restyle(shape):
                drawn[key].move(pose)
                continue
            if key in drawn:
                drawn[key].handle.remove()
            self._count += 1  # names from outside may hold slashes, which viser takes for a hierarchy
            drawn[key] = _SceneNode(self._draw(f"/{group}/{self._count}", shape, pose), shape, pose)

    def draws(self, group: str) -> bool:
        """Return whether anything of the group is shown."""
        return bool(self._groups.get(group))

    def _draw(self, name: str, shape: Visual, pose: Pose3D) -> Any:
        where = {"position": pose.position, "wxyz": _wxyz(pose)}
        if shape.kind == BODY:
            handle = self._api.add_frame(name, show_axes=False, **where)
            for number, (part, part_pose) in enumerate(shape.parts):
                self._draw(f"{name}/{number}", part, part_pose)
            return handle
        fixed, changeable = _options(shape)
        return getattr(self._api, f"add_{shape.kind}")(name, **fixed, **changeable, **where)
