"""The world for RViz and for localization: obstacle and robot markers; and the map, as map_server offers it."""

from typing import Any, Callable, List, Optional

import ros_numpy
import rospy
from genpy import Time
from geometry_msgs.msg import Point, Pose
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from ...names import FOOTPRINT_FRAME, MAP_FRAME, WORLD_FRAME, prefixed
from ...simulation.simulator import Simulator
from ...world.model import Occupancy
from .. import convert
from ..publishing.batch import Batch
from ..publishing.packed import PackedMessage
from ..publishing.publisher import publisher
from .world_markers import CLEAR, robot_markers, world_markers

# With an array of cells: as lists, genpy would make Python objects of up to 16 million of them.
Grid, MapResponse = numpy_msg(OccupancyGrid), numpy_msg(GetMapResponse)


def to_grid(occupancy: Occupancy, stamp: Time, frame: str) -> OccupancyGrid:
    """An occupancy grid as a message."""
    origin = occupancy.origin
    pose = Pose(Point(origin.x, origin.y, 0.0), convert.to_quaternion(origin.yaw))
    info = MapMetaData(map_load_time=stamp, resolution=occupancy.resolution, origin=pose)
    grid = ros_numpy.msgify(OccupancyGrid, occupancy.cells, info=info)
    return Grid(Header(0, stamp, frame), grid.info, grid.data)


class _WorldMarkers(MarkerArray):
    """A message with the whole world as it is when the message is sent, also to a subscriber that comes later."""

    def __init__(self, markers: Callable[[], List[Marker]]) -> None:
        super().__init__()
        self._make = markers

    def serialize(self, buff: Any) -> None:
        """Write the serialized message to a buffer, as genpy's messages do."""
        MarkerArray(self._make()).serialize(buff)


class WorldTopics:
    """~world, latched; where a map is published also /map and /map_metadata, latched, and the service /static_map."""

    def __init__(self, simulator: Simulator) -> None:
        """Robots with a name are shown as markers; a lone robot without one by RViz's RobotModel instead."""
        self._simulator = simulator
        self._robots = [
            (robot.name, prefixed(robot.name, FOOTPRINT_FRAME), radius)
            for robot, radius in zip(simulator.robots, simulator.fleet.radii.tolist())
            if robot.name
        ]
        self._markers = publisher("~world", MarkerArray, latch=True)
        self._has_map = simulator.params.topics.publish_map or simulator.world.occupancy is not None
        self._grid: Optional[OccupancyGrid] = None  # that was published last
        if self._has_map:
            self._map = publisher("/map", OccupancyGrid, latch=True)
            self._metadata = publisher("/map_metadata", MapMetaData, latch=True)

    def publish(self) -> None:
        """Publish the whole world, which replaces the markers that were published before."""
        if self._has_map:
            self._publish_map()
        self._markers.publish(_WorldMarkers(lambda: [CLEAR, *self._obstacles(), *robot_markers(self._robots)]))

    def publish_moving(self) -> None:
        """The moving obstacles where they are now."""
        if self._markers.get_num_connections():
            moving = PackedMessage(MarkerArray(self._obstacles(moving=True)))
            Batch([(self._markers, moving)]).send(self._simulator.stamp_ns)

    def _obstacles(self, moving: bool = False) -> List[Marker]:
        simulator = self._simulator
        return world_markers(simulator.world, WORLD_FRAME, simulator.world_time, moving)

    def _publish_map(self) -> None:
        """A stamp of zero would mean that there is no map."""
        stamp = max(convert.to_time(self._simulator.stamp_ns), Time(0, 1))
        is_first = self._grid is None
        self._grid = to_grid(self._simulator.occupancy(), stamp, MAP_FRAME)
        self._map.publish(self._grid)
        self._metadata.publish(self._grid.info)
        if is_first:
            rospy.Service("/static_map", GetMap, lambda _: MapResponse(self._grid))
