"""The page's 3D scene: groups of shapes, drawn by viser."""

from dataclasses import replace
from typing import Any, Dict, Hashable, Tuple

import numpy as np

from ..geometry import Pose3D
from .shapes import BODY, BOX, CYLINDER, FRAME, IMAGE, LINE, MESH, POINTS, SPHERE, TEXT, Group, Shape

STILL = 1e-4  # [m] and quaternion units: smaller changes of a pose are not sent
LOOK = ("color", "opacity")
CHANGEABLE = {  # what may differ between two shapes of a kind without drawing anew
    **dict.fromkeys((BOX, CYLINDER, SPHERE, MESH), LOOK),
    TEXT: ("text", *LOOK),
    LINE: ("points", *LOOK),
    POINTS: ("points",),
}
FLAT = {"cast_shadow": False, "receive_shadow": False}


def _wxyz(pose: Pose3D) -> Tuple[float, float, float, float]:
    x, y, z, w = pose.orientation
    return (w, x, y, z)


def _segments(shape: Shape) -> np.ndarray:
    points = np.array(shape.points, dtype=np.float32)
    return np.stack([points[:-1], points[1:]], axis=1)


class _Drawn:
    """A shape in the scene, with the handle of viser, and the shape and the pose that were sent last."""

    def __init__(self, handle: Any, shape: Shape, pose: Pose3D) -> None:
        self.handle = handle
        self._shape = shape
        self._pose = pose

    def move(self, pose: Pose3D) -> None:
        new, old = (*pose.position, *pose.orientation), (*self._pose.position, *self._pose.orientation)
        if any(abs(a - b) > STILL for a, b in zip(new, old)):
            self.handle.position, self.handle.wxyz = pose.position, _wxyz(pose)
            self._pose = pose

    def restyle(self, new: Shape) -> bool:
        """Change what can be changed in place; False if the shape has to be drawn anew."""
        old, self._shape = self._shape, new
        if old == new:
            return True
        kept = {name: getattr(new, name) for name in CHANGEABLE.get(new.kind, ())}
        if not kept or replace(old, **kept) != new:
            return False
        if new.kind == TEXT:
            self.handle.text = new.text
        elif new.kind == LINE:
            self.handle.points, self.handle.colors = _segments(new), np.array(new.color, dtype=np.uint8)
        elif new.kind == POINTS:
            self.handle.points = np.array(new.points, dtype=np.float32)
        else:
            self.handle.color, self.handle.opacity = new.color, new.opacity
        return True


class PageScene:
    """What all browsers show. `api` is the scene of a viser server; calls from one thread only."""

    def __init__(self, api: Any) -> None:
        self._api = api
        self._groups: Dict[str, Dict[Hashable, _Drawn]] = {}
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
            drawn[key] = _Drawn(self._draw(f"/{group}/{self._count}", shape, pose), shape, pose)

    def draws(self, group: str) -> bool:
        """Whether anything of the group is shown."""
        return bool(self._groups.get(group))

    def _draw(self, name: str, shape: Shape, pose: Pose3D) -> Any:
        api, kind, color, size = self._api, shape.kind, shape.color, shape.size
        where: Dict[str, Any] = {"position": pose.position, "wxyz": _wxyz(pose)}
        look = {**FLAT, **where, "opacity": shape.opacity if shape.opacity < 1.0 else None}
        if kind == BOX:
            return api.add_box(name, color, size, **look)
        if kind == CYLINDER:
            return api.add_cylinder(name, size[0] / 2.0, size[2], color, **look)
        if kind == SPHERE:
            return api.add_icosphere(name, size[0] / 2.0, color, **look)
        if kind == MESH:
            corners = np.array(shape.points, dtype=np.float32)
            faces = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
            return api.add_mesh_simple(name, corners, faces, color=color, side="double", flat_shading=True, **look)
        if kind == LINE:
            return api.add_line_segments(name, _segments(shape), color, thickness=size[0], **where)
        if kind == POINTS:
            points, style = np.array(shape.points), {"point_shape": "circle", "precision": "float32"}
            return api.add_point_cloud(name, points, color, point_size=size[0], **style, **where)
        if kind == TEXT:
            return api.add_label(name, shape.text, anchor="bottom-center", **where)
        if kind == IMAGE:
            return api.add_image(name, shape.image, size[0], size[1], **FLAT, **where)
        if kind == FRAME:
            handle = api.add_frame(name, axes_length=0.12, axes_radius=0.005, **where)
            api.add_label(f"{name}/name", shape.text, anchor="top-left", font_screen_scale=0.8)
            return handle
        if kind == BODY:
            handle = api.add_frame(name, show_axes=False, **where)
            for number, (part, part_pose) in enumerate(shape.parts):
                self._draw(f"{name}/{number}", part, part_pose)
            return handle
        raise ValueError(f"no shape of the kind {kind!r}")
