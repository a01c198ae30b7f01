"""The world for RViz and for localization: obstacle and robot markers, and the map."""

from typing import Any, Callable, List, Optional

from visualization_msgs.msg import Marker, MarkerArray

from ...simulation.simulator import Simulator
from .. import convert
from ..batch import Batch
from ..names import prefixed
from ..packed import PackedMessage
from ..publishing import publisher
from .map_topics import MapTopics
from .world_markers import CLEAR, robot_markers, world_markers


class _Whole(MarkerArray):
    """The whole world at the time at which it is sent, also to a subscriber that comes later."""

    def __init__(self, markers: Callable[[], List[Marker]]) -> None:
        super().__init__()
        self._make = markers

    def serialize(self, buff: Any) -> None:
        """As genpy's messages do it."""
        MarkerArray(self._make()).serialize(buff)


class WorldTopics:
    """~world, latched, and /map where a map is published."""

    def __init__(self, simulator: Simulator) -> None:
        """Robots with a name are shown as markers; a lone robot without one by RViz's RobotModel instead."""
        p = simulator.p
        self._frames = p.frames
        self._robots = [
            (robot.name, prefixed(robot.name, p.frames.base_frame), radius)
            for robot, radius in zip(simulator.robots, simulator.fleet.radii.tolist())
            if robot.name
        ]
        self._markers = publisher("~world", MarkerArray, latch=True)
        publish_map = p.topics.publish_map or simulator.world.occupancy is not None
        self._maps: Optional[MapTopics] = MapTopics() if publish_map else None

    def publish(self, simulator: Simulator) -> None:
        """The whole world, which replaces what was published before."""
        if self._maps is not None:
            self._maps.publish(simulator.occupancy(), convert.to_time(simulator.stamp_ns), self._frames.map_frame)
        self._markers.publish(_Whole(lambda: self._all(simulator)))

    def publish_moving(self, simulator: Simulator) -> None:
        """The moving obstacles where they are now."""
        if self._markers.get_num_connections():
            Batch([(self._markers, PackedMessage(MarkerArray(self._moving(simulator))))]).send(simulator.stamp_ns)

    def _all(self, simulator: Simulator) -> List[Marker]:
        world = world_markers(simulator.world, self._frames.world_frame, simulator.world_time)
        return [CLEAR, *world, *robot_markers(self._robots)]

    def _moving(self, simulator: Simulator) -> List[Marker]:
        return world_markers(simulator.world, self._frames.world_frame, simulator.world_time, moving=True)
