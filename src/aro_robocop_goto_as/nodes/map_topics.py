"""The world as a grid map on /map and /map_metadata, latched, as map_server has them."""

import struct
from io import BytesIO
from typing import Any

import ros_numpy
from genpy import Time
from geometry_msgs.msg import Point, Pose
from nav_msgs.msg import MapMetaData, OccupancyGrid
from std_msgs.msg import Header

from ..shapes import Occupancy
from . import convert
from .publishing import publisher

_LENGTH = struct.Struct("<I")


class PackedGrid(OccupancyGrid):
    """An OccupancyGrid whose cells are an array: genpy would make a Python object of each of 16 million."""

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it."""
        empty = BytesIO()
        OccupancyGrid(self.header, self.info, []).serialize(empty)
        buff.write(empty.getvalue()[: -_LENGTH.size])
        buff.write(_LENGTH.pack(len(self.data)))
        buff.write(self.data.tobytes())


def to_grid(occupancy: Occupancy, stamp: Time, frame: str) -> PackedGrid:
    """A grid map as a message."""
    origin = occupancy.origin
    pose = Pose(Point(origin.x, origin.y, 0.0), convert.to_quaternion(origin.yaw))
    info = MapMetaData(map_load_time=stamp, resolution=occupancy.resolution, origin=pose)
    grid = ros_numpy.msgify(OccupancyGrid, occupancy.cells, info=info)
    return PackedGrid(Header(0, stamp, frame), grid.info, grid.data)


class MapTopics:
    """The publishers of a map that changes seldom, or never."""

    def __init__(self) -> None:
        self.map = publisher("/map", OccupancyGrid, latch=True)
        self.metadata = publisher("/map_metadata", MapMetaData, latch=True)

    def publish(self, occupancy: Occupancy, stamp: Time, frame: str) -> None:
        """A map from now on; frame: the one that its origin is in."""
        grid = to_grid(occupancy, stamp, frame)
        self.map.publish(grid)
        self.metadata.publish(grid.info)
