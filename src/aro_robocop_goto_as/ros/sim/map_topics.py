"""The world as an occupancy grid, as map_server offers it: on /map and /map_metadata, latched, and by /static_map."""

import struct
from io import BytesIO
from typing import Any, Optional

import ros_numpy
import rospy
from genpy import Time
from geometry_msgs.msg import Point, Pose
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapRequest, GetMapResponse
from std_msgs.msg import Header

from ...world.model import Occupancy
from .. import convert
from ..publishing import publisher

_LENGTH = struct.Struct("<I")


class PackedGrid(OccupancyGrid):
    """An OccupancyGrid whose cells are an array: genpy would make a Python object of each of up to 16 million cells."""

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it."""
        empty = BytesIO()
        OccupancyGrid(self.header, self.info, []).serialize(empty)
        buff.write(empty.getvalue()[: -_LENGTH.size])
        buff.write(_LENGTH.pack(len(self.data)))
        buff.write(self.data.tobytes())


def to_grid(occupancy: Occupancy, stamp: Time, frame: str) -> PackedGrid:
    """An occupancy grid as a message."""
    origin = occupancy.origin
    pose = Pose(Point(origin.x, origin.y, 0.0), convert.to_quaternion(origin.yaw))
    info = MapMetaData(map_load_time=stamp, resolution=occupancy.resolution, origin=pose)
    grid = ros_numpy.msgify(OccupancyGrid, occupancy.cells, info=info)
    return PackedGrid(Header(0, stamp, frame), grid.info, grid.data)


class PackedMap(GetMapResponse):
    """The response of /static_map with a PackedGrid."""

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it; the map is the only field."""
        self.map.serialize(buff)


class MapTopics:
    """The publishers of a map, and the service that answers with the map published last."""

    def __init__(self) -> None:
        self.map = publisher("/map", OccupancyGrid, latch=True)
        self.metadata = publisher("/map_metadata", MapMetaData, latch=True)
        self._newest: Optional[PackedGrid] = None

    def publish(self, occupancy: Occupancy, stamp: Time, frame: str) -> None:
        """Publish a map whose origin is in this frame; a stamp of zero would mean that there is none."""
        grid = to_grid(occupancy, max(stamp, Time(0, 1)), frame)
        self.map.publish(grid)
        self.metadata.publish(grid.info)
        is_first, self._newest = self._newest is None, grid
        if is_first:
            rospy.Service("/static_map", GetMap, self._on_static_map)

    def _on_static_map(self, _request: GetMapRequest) -> PackedMap:
        return PackedMap(self._newest)
