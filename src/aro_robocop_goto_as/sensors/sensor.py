"""The interface of a sensor, and the robots, world and noise that all sensors share.

Noise is repeatable by seed, stream and step: of slip, IMU and number of beams here, of ranges in lidar.c.
"""

import ctypes
from typing import Callable, Sequence

import numpy as np

from ..geometry import Pose2D
from ..physics.engine import Engine
from ..raycast.scanners import Scanners
from ..world.model import World

Robots = Sequence[int]  # indices
Calls = Sequence[Callable[[], object]]


class Episode(ctypes.Structure):
    """What all noise depends on; `struct episode` of lidar.c.

    seed: of this episode, which begins at a reset
    step: steps since its beginning
    """

    _fields_ = [("seed", ctypes.c_uint64), ("step", ctypes.c_uint64)]
    seed: int
    step: int


class NoiseStreams:
    """One generator, set to the beginning of a stream on the present step.

    A new Philox for each stream would read entropy from the system, which costs more than the noise.
    """

    def __init__(self, episode: Episode) -> None:
        self._episode = episode
        self._generator = np.random.Generator(np.random.Philox(0))
        self._state = self._generator.bit_generator.state

    def stream(self, number: int) -> np.random.Generator:
        """The generator at the beginning of a stream on this step; valid until the next call."""
        self._generator.bit_generator.state = {
            **self._state,
            "state": {
                "counter": np.array([0, 0, 0, self._episode.step], np.uint64),
                "key": np.array([self._episode.seed, number], np.uint64),
            },
        }
        return self._generator


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
