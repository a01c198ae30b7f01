"""The world for RViz and for localization: obstacle and robot markers, and the map."""

from typing import List, Optional, Sequence, Tuple

from visualization_msgs.msg import Marker, MarkerArray

from ...component_params import FrameNames
from ...simulation.simulator import Simulator
from .. import convert
from ..packed import PackedMessage
from ..private_api import set_latched
from ..publishing import publisher, send
from .map_topics import MapTopics
from .world_markers import CLEAR, robot_markers, world_markers

NamedRobot = Tuple[str, str, float]  # name, base frame, radius [m]


class WorldTopics:
    """~world, latched, and /map where a map is published."""

    def __init__(self, frames: FrameNames, publish_map: bool, robots: Sequence[NamedRobot]) -> None:
        """`robots` are shown as markers; a lone robot without a name is shown by RViz's RobotModel instead."""
        self._frames = frames
        self._robots = robots
        self._markers = publisher("~world", MarkerArray, latch=True)
        self._standing: List[Marker] = []  # as published last: what does not move, and the robots
        self._maps: Optional[MapTopics] = MapTopics() if publish_map else None

    def publish(self, simulator: Simulator) -> None:
        """The whole world, which replaces what was published before."""
        if self._maps is not None:
            self._maps.publish(simulator.occupancy(), convert.to_time(simulator.stamp_ns), self._frames.map)
        moving = self._moving(simulator)
        moving_ids = {marker.id for marker in moving}
        markers = world_markers(simulator.world, self._frames.world, simulator.world_time)
        self._standing = [marker for marker in markers if marker.id not in moving_ids] + robot_markers(self._robots)
        self._markers.publish([CLEAR, *self._standing, *moving])

    def publish_moving(self, simulator: Simulator) -> None:
        """The moving obstacles where they are now; a later subscriber gets the whole world with them."""
        moving = self._moving(simulator)
        set_latched(self._markers, MarkerArray([CLEAR, *self._standing, *moving]))
        if self._markers.get_num_connections():
            send(self._markers, PackedMessage(MarkerArray(moving)))

    def _moving(self, simulator: Simulator) -> List[Marker]:
        return world_markers(simulator.world, self._frames.world, simulator.world_time, moving=True)
