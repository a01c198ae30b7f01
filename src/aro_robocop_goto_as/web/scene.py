"""The 3D scene: shapes, robots, scan, trail and frames, drawn by viser."""

import math
from dataclasses import replace
from typing import Any, Dict, Hashable, List, Mapping, Optional, Tuple

import numpy as np

from ..geometry import Pose3D
from .shapes import BOX, CYLINDER, LINE, MESH, SPHERE, TEXT, Group, Placed, Shape

FLOOR_SIZE = 40.0  # [m] of the grid
SCAN_COLOR, SCAN_SIZE = (255, 85, 70), 0.025
TRAIL_COLOR, TRAIL_WIDTH, TRAIL_HEIGHT = (90, 200, 250), 0.012, 0.012
MAP_HEIGHT = 0.003  # [m] above the grid, below goal and trail
CROWDED = 0.06  # [m] between two frames; nearer ones hide each other's names
STILL = 1e-4  # [m] and quaternion units: smaller changes of a pose are not sent


def _wxyz(pose: Pose3D) -> Tuple[float, float, float, float]:
    x, y, z, w = pose.orientation
    return (w, x, y, z)


def _differ(a: Pose3D, b: Pose3D) -> bool:
    return any(abs(p - q) > STILL for p, q in zip((*a.position, *a.orientation), (*b.position, *b.orientation)))


def _restyled(handle: Any, old: Shape, new: Shape) -> bool:
    """Give a drawn shape its new text or colour; False if it has to be drawn anew."""
    if old == new:
        return True
    if replace(old, color=new.color, opacity=new.opacity, text=new.text) != new:
        return False
    if new.kind == TEXT:
        handle.text = new.text
    elif new.kind == LINE:
        handle.colors = np.array(new.color, dtype=np.uint8)
    else:
        handle.color, handle.opacity = new.color, new.opacity
    return True


def _apart(poses: Mapping[str, Pose3D]) -> Dict[str, Pose3D]:
    kept: Dict[str, Pose3D] = {}
    for name, pose in poses.items():
        if all(math.dist(pose.position, other.position) > CROWDED for other in kept.values()):
            kept[name] = pose
    return kept


class _Node:
    """A handle of viser with the pose that was sent last."""

    def __init__(self, handle: Any, pose: Pose3D) -> None:
        self.handle = handle
        self.pose = pose

    def move(self, pose: Pose3D) -> None:
        if _differ(pose, self.pose):
            self.handle.position, self.handle.wxyz = pose.position, _wxyz(pose)
            self.pose = pose


class Scene:
    """What all pages show. `api` is the scene of a viser server; calls from one thread only."""

    def __init__(self, api: Any) -> None:
        self._api = api
        self._groups: Dict[str, Dict[Hashable, Tuple[Shape, _Node]]] = {}
        self._links: Dict[str, Dict[str, _Node]] = {}
        self._frames: Dict[str, _Node] = {}
        self._scan: Any = None
        self._trail: Any = None
        self._map: Any = None
        self._count = 0
        api.set_up_direction("+z")
        api.add_grid(
            "/floor",
            FLOOR_SIZE,
            FLOOR_SIZE,
            cell_size=0.5,
            section_size=1.0,
            cell_color=(70, 76, 88),
            section_color=(95, 103, 118),
            plane_color=(38, 42, 50),
            plane_opacity=1.0,
            shadow_opacity=0.0,
        )

    def _unique(self, group: str) -> str:
        """A name for a new node; names from outside may hold slashes, which viser takes for a hierarchy."""
        self._count += 1
        return f"/{group}/{self._count}"

    def show_group(self, group: str, shapes: Group) -> None:
        """Show these shapes, and none that the group held before and does not hold now; poses in the fixed frame."""
        shown = self._groups.setdefault(group, {})
        for key in [key for key in shown if key not in shapes]:
            shown.pop(key)[1].handle.remove()
        for key, (shape, pose) in shapes.items():
            old = shown.get(key)
            if old is not None and _restyled(old[1].handle, old[0], shape):
                old[1].move(pose)
                shown[key] = (shape, old[1])
            else:
                if old is not None:
                    old[1].handle.remove()
                shown[key] = (shape, _Node(self._draw(self._unique(group), shape, pose), pose))

    def _draw(self, name: str, shape: Shape, pose: Pose3D) -> Any:
        api, where = self._api, {"position": pose.position, "wxyz": _wxyz(pose)}
        look = {
            "opacity": shape.opacity if shape.opacity < 1.0 else None,
            "cast_shadow": False,
            "receive_shadow": False,
        }
        if shape.kind == BOX:
            return api.add_box(name, shape.color, shape.size, **look, **where)
        if shape.kind == CYLINDER:
            return api.add_cylinder(name, shape.size[0] / 2.0, shape.size[2], shape.color, **look, **where)
        if shape.kind == SPHERE:
            return api.add_icosphere(name, shape.size[0] / 2.0, shape.color, **look, **where)
        points = np.array(shape.points, dtype=np.float32).reshape(-1, 3)
        if shape.kind == MESH:
            faces = np.arange(len(points), dtype=np.uint32).reshape(-1, 3)
            return api.add_mesh_simple(
                name, points, faces, color=shape.color, side="double", flat_shading=True, **look, **where
            )
        if shape.kind == LINE:
            segments = np.stack([points[:-1], points[1:]], axis=1)
            return api.add_line_segments(name, segments, shape.color, thickness=shape.size[0], **where)
        if shape.kind == TEXT:
            return api.add_label(name, shape.text, anchor="bottom-center", **where)
        raise ValueError(f"no shape of the kind {shape.kind!r}")

    def set_robot(self, robot: str, links: Mapping[str, List[Placed]]) -> None:
        """Draw a robot's links, which place_robot puts into place; replaces the robot of this name."""
        self.remove_robot(robot)
        nodes = self._links[robot] = {}
        for link, visuals in links.items():
            root = self._unique("robots")
            nodes[link] = _Node(self._api.add_frame(root, show_axes=False, visible=False), Pose3D())
            for number, (shape, pose) in enumerate(visuals):
                self._draw(f"{root}/{number}", shape, pose)

    def remove_robot(self, robot: str) -> None:
        """Remove a robot, if it is there."""
        for node in self._links.pop(robot, {}).values():
            node.handle.remove()

    def place_link(self, robot: str, link: str, pose: Optional[Pose3D]) -> None:
        """Place a link's shapes in the fixed frame, or hide them where its place is not known."""
        node = self._links[robot][link]
        node.handle.visible = pose is not None
        if pose is not None:
            node.move(pose)

    def show_scan(self, points: np.ndarray) -> None:
        """Points (n, 3) [m] in the fixed frame; none hides the scan."""
        if self._scan is None:
            self._scan = self._api.add_point_cloud(
                "/scan",
                np.zeros((1, 3)),
                SCAN_COLOR,
                point_size=SCAN_SIZE,
                point_shape="circle",
                precision="float32",
            )
        self._scan.visible = len(points) > 0
        if len(points):
            self._scan.points = points.astype(np.float32)

    def show_trail(self, segments: np.ndarray) -> None:
        """Pairs of points (n, 2, 3) [m] in the fixed frame; none hides the trail."""
        if self._trail is None:
            if not len(segments):
                return
            self._trail = self._api.add_line_segments("/trail", segments, TRAIL_COLOR, thickness=TRAIL_WIDTH)
        self._trail.visible = len(segments) > 0
        if len(segments):
            self._trail.points = segments

    def show_frames(self, poses: Mapping[str, Pose3D]) -> None:
        """Axes and names of these frames, of no others, and of the first one only where several are in one place."""
        poses = _apart(poses)
        for name in [name for name in self._frames if name not in poses]:
            self._frames.pop(name).handle.remove()
        for name, pose in poses.items():
            if name in self._frames:
                self._frames[name].move(pose)
                continue
            root = self._unique("frames")
            handle = self._api.add_frame(
                root, axes_length=0.12, axes_radius=0.005, position=pose.position, wxyz=_wxyz(pose)
            )
            self._api.add_label(f"{root}/name", name, anchor="top-left", font_screen_scale=0.8)
            self._frames[name] = _Node(handle, pose)

    def show_map(self, image: Optional[np.ndarray], width: float, height: float, pose: Pose3D) -> None:
        """An image (rows, columns, 4) of this size [m] whose centre is at a pose, or no map."""
        if self._map is not None:
            self._map.remove()
            self._map = None
        if image is not None:
            x, y, z = pose.position
            self._map = self._api.add_image(
                "/map",
                image,
                width,
                height,
                cast_shadow=False,
                receive_shadow=False,
                position=(x, y, z + MAP_HEIGHT),
                wxyz=_wxyz(pose),
            )
