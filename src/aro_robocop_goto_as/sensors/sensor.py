"""The interface of a sensor, and the robots, world and noise that all sensors share.

Noise is repeatable by seed, stream and step: of the lidar's ranges in lidar.c, of the other sensors by NoiseStreams.
"""

import ctypes
from dataclasses import dataclass
from functools import partial
from typing import Callable, Dict, NamedTuple, Sequence

import numpy as np

from ..geometry import Pose2D
from ..physics.engine import Engine
from ..raycast.scenes import BeamScenes, Mounts
from ..world.model import World

RobotIndices = Sequence[int]  # indices
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
    """One generator, set to the beginning of a stream on the present step. Each noise has streams of its own.

    A new Philox for each stream would read entropy from the system, which costs more than the noise.
    """

    FIRST_IMU = 1  # and one for each further robot
    ENCODERS = 2**32  # of all robots

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


class SensorContext:
    """Robots in a world, where sensors measure, and the noise of the present step."""

    def __init__(self, world: World, engine: Engine, rate: int, seed: int) -> None:
        """`rate` [Hz] of the steps."""
        self.world, self.engine, self.rate = world, engine, rate
        self.fleet, self.models = engine.fleet, engine.fleet.models
        self.scenes = BeamScenes(self.models, world, self.fleet.poses)
        self.episode = Episode(seed, 0)
        self.noise = NoiseStreams(self.episode)

    @property
    def time(self) -> float:
        """Simulated time [s] since the last reset; the poses of moving obstacles are functions of it."""
        return self.episode.step / self.rate

    def reset(self, seed: int) -> None:
        """Begin a new episode, with noise and moving obstacles at their start."""
        self.episode.seed, self.episode.step = seed, 0
        self.scenes.move(0.0)

    def change_world(self, world: World) -> None:
        """Replace the world; its moving obstacles are where they are at the present time."""
        self.world = world
        self.scenes.change_world(world)
        self.scenes.move(self.time)


@dataclass(frozen=True)
class RateParams:
    """Parameters of a sensor; the names of its rates end with _rate."""

    def rates(self) -> Dict[str, int]:
        """The rates [Hz] by the names of their parameters; 0: never."""
        return {name: value for name, value in vars(self).items() if name.endswith("_rate")}


class MeasurementCalls(NamedTuple):
    """The calls that measure some robots, made once for all steps that are alike."""

    measure: Calls  # after the step
    before: Calls = ()  # just before the step


class Sensor:
    """A sensor that every robot has; of its arrays, each robot's row is changed in place when the sensor is due.

    An ordinary sensor overrides measure(). A sensor that C measures, or that also looks at the robots before the step,
    overrides measurement_calls() instead.
    """

    topic = ""  # in the robot's namespace; sensors are called by it
    always_on = False  # whether it measures also while nobody subscribes
    frame = ""  # of its own, if the robots' URDF has none for it
    mounts: Mounts = ()  # base_from_sensor of each robot; on /tf_static if the sensor has a frame of its own

    def __init__(self, context: SensorContext, rate: int) -> None:
        """`rate` [Hz]; 0: never."""
        self.context, self.rate = context, rate

    def measure(self, robots: RobotIndices) -> None:
        """Measure these robots."""

    def measurement_calls(self, robots: RobotIndices) -> MeasurementCalls:
        """The calls that measure these robots, with the fleet's rows up to date; anew after a change of the world."""
        return MeasurementCalls([partial(self.measure, robots)])

    def reset(self, _spawns: Sequence[Pose2D]) -> None:
        """Begin anew: the robots are at their spawn poses."""

    def close(self) -> None:
        """Free the resources of the present world."""
