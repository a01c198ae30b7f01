"""RViz markers -> shapes of the page's scene."""

import math
from typing import Callable, Dict, Optional, Sequence, Tuple, Union

from geometry_msgs.msg import Point, Quaternion, Vector3
from visualization_msgs.msg import Marker, MarkerArray

from ..errors import FrameError
from ..geometry import Pose3D, compose3
from ..web.scene import BOX, CYLINDER, LINE, MESH, SPHERE, TEXT, Group, Visual, color_of
from .convert import from_quaternion

KINDS = {
    Marker.CUBE: BOX,
    Marker.CYLINDER: CYLINDER,
    Marker.SPHERE: SPHERE,
    Marker.TRIANGLE_LIST: MESH,
    Marker.LINE_STRIP: LINE,
    Marker.TEXT_VIEW_FACING: TEXT,
}
Key = Tuple[str, int]  # namespace and id
VisualInFrame = Tuple[str, Visual, Pose3D]  # frame, shape, pose in that frame


def to_pose(p: Union[Point, Vector3], q: Quaternion) -> Optional[Pose3D]:
    """A pose in space with a unit quaternion; None if the numbers are no pose. All zeros mean level, as in RViz."""
    try:
        orientation = from_quaternion(q, unset_is_level=True)
    except FrameError:
        return None
    return Pose3D((p.x, p.y, p.z), orientation) if all(map(math.isfinite, (p.x, p.y, p.z))) else None


def to_shape(marker: Marker) -> Optional[Visual]:
    """A marker's shape, None for kinds that are not shown and for impossible figures."""
    kind = KINDS.get(marker.type)
    size = (marker.scale.x, marker.scale.y, marker.scale.z)
    color = (marker.color.r, marker.color.g, marker.color.b, marker.color.a)
    points = tuple((point.x, point.y, point.z) for point in marker.points)
    if kind is None or not all(math.isfinite(value) for value in (*size, *color, *(v for p in points for v in p))):
        return None
    if (kind == MESH and (not points or len(points) % 3)) or (kind == LINE and len(points) < 2):
        return None
    return Visual(kind, size, *color_of(color), points, marker.text[:500])


class MarkerStore:
    """The markers of one topic, after all its additions and deletions."""

    def __init__(self) -> None:
        self._markers: Dict[Key, VisualInFrame] = {}

    def apply(self, message: MarkerArray) -> None:
        """Apply a message in the order of its markers; markers that can't be shown are left out."""
        for marker in message.markers:
            key = (marker.ns, marker.id)
            if marker.action == Marker.DELETEALL:
                self._markers.clear()
                continue
            shape = None if marker.action == Marker.DELETE else to_shape(marker)
            pose = to_pose(marker.pose.position, marker.pose.orientation)
            if shape is None or pose is None:
                self._markers.pop(key, None)
            else:
                self._markers[key] = (marker.header.frame_id.lstrip("/"), shape, pose)

    def placed(self, lookup: Callable[[str], Optional[Pose3D]], skip: Sequence[str] = ()) -> Group:
        """Shapes with poses in the frame of `lookup`, which returns fixed_from_frame, without some namespaces."""
        fixed_from = {frame: lookup(frame) for frame in {frame for frame, _, _ in self._markers.values()}}
        group: Group = {}
        for key, (frame, shape, pose) in self._markers.items():
            origin = fixed_from[frame]
            if origin is not None and key[0] not in skip:
                group[key] = (shape, compose3(origin, pose))
        return group
