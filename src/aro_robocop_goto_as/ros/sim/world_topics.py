"""The world for RViz and for localization: obstacle and robot markers, and the map."""

from typing import Optional, Sequence, Tuple

from visualization_msgs.msg import MarkerArray

from ...component_params import FrameNames
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing import publisher
from .map_topics import MapTopics
from .world_markers import CLEAR, robot_markers, world_markers

NamedRobot = Tuple[str, str, float]  # name, base frame, radius [m]


class WorldTopics:
    """~world, latched, and /map where a map is published."""

    def __init__(self, frames: FrameNames, publish_map: bool, robots: Sequence[NamedRobot]) -> None:
        """`robots` are shown as markers; a lone robot without a name is shown by RViz's RobotModel instead."""
        self._frames = frames
        self._robots = robots
        self._joined = False  # somebody has subscribed since the whole world was published
        self._markers = publisher("~world", MarkerArray, latch=True, on_change=self._on_change)
        self._maps: Optional[MapTopics] = MapTopics() if publish_map else None

    def _on_change(self) -> None:
        self._joined = True

    def publish(self, simulator: Simulator) -> None:
        """The whole world, which replaces what was published before."""
        if self._maps is not None:
            self._maps.publish(simulator.occupancy(), convert.to_time(simulator.stamp_ns), self._frames.map)
        markers = world_markers(simulator.world, self._frames.world, simulator.world_time)
        self._markers.publish([CLEAR, *markers, *robot_markers(self._robots)])

    def publish_moving(self, simulator: Simulator) -> None:
        """The moving obstacles where they are now; everything for a new subscriber, who got only the latched ones."""
        joined, self._joined = self._joined, False
        made = world_markers(simulator.world, self._frames.world, simulator.world_time, moving=not joined)
        self._markers.publish(made + robot_markers(self._robots) if joined else made)
