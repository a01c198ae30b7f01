"""The interface of a sensor, and the robots, world and noise that all sensors share."""

from typing import Callable, Sequence

from ..geometry import Pose2D
from ..physics.engine import Engine
from ..raycast.scanners import Scanners
from ..world.model import World
from .noise_streams import Episode, NoiseStreams

Robots = Sequence[int]  # indices
Calls = Sequence[Callable[[], object]]


class Site:
    """Robots in a world, where sensors measure, and the noise of the present step."""

    def __init__(self, world: World, engine: Engine, rate: int, seed: int) -> None:
        """`rate` [Hz] of the steps."""
        self.world, self.engine, self.rate = world, engine, rate
        self.fleet, self.models = engine.fleet, engine.fleet.models
        self.scanners = Scanners(self.models, world, self.fleet.poses)
        self.episode = Episode(seed, 0)
        self.noise = NoiseStreams(self.episode)

    @property
    def time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return self.episode.step / self.rate


class Sensor:
    """A sensor that every robot has; of its arrays, each robot's row is changed in place when the sensor is due."""

    name = ""
    unasked = False  # whether it is measured also while nobody subscribes
    reads_fleet = True  # whether the fleet's rows have to be up to date before it measures

    def __init__(self, site: Site, rate: int) -> None:
        """`rate` [Hz]; 0: never."""
        self.site, self.rate = site, rate

    def before_step(self, _robots: Robots) -> Calls:
        """The function to call just before a step on which these robots are measured."""
        return ()

    def measuring(self, _robots: Robots) -> Calls:
        """The function that measures these robots; it is asked for once for all steps that are alike."""
        return ()

    def reset(self, _spawns: Sequence[Pose2D]) -> None:
        """Begin anew: the robots are at their spawn poses."""

    def close(self) -> None:
        """Free the resources of the present world."""
