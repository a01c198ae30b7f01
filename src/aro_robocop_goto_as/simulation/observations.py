"""What one step yields: what is due, and the measurements."""

from dataclasses import dataclass, field
from typing import FrozenSet, Mapping, Sequence

from ..geometry import Pose2D
from ..physics.engine import Engine
from ..sensors.catalog import Sensors
from ..sensors.sensor import Calls, Robots, Site
from ..sim_params import SimParams
from ..world.model import World
from .schedule import CLOCK

Subscriptions = Mapping[str, Robots]  # sensor -> the robots for which somebody subscribes to it


@dataclass(eq=False)
class Due:
    """What is due on a step; the same object on all steps that are alike, while the subscriptions stay the same."""

    clock: bool = False  # a clock tick: /clock is due
    control: bool = False  # a control tick: the controllers' period is over
    sensors: Subscriptions = field(default_factory=dict)  # those that are due, for whom they are subscribed to
    before: Calls = ()  # the calls just before the step
    measures: Calls = ()  # the calls that measure what is due
    names: FrozenSet[str] = field(init=False)  # of these sensors, and CLOCK if it is due

    def __post_init__(self) -> None:
        self.names = frozenset([*self.sensors, *([CLOCK] if self.clock else [])])


class Observations(Sensors):
    """The sensors of all robots, and what they measured last; one object, changed in place.

    A row of a sensor is new where the sensor was due for its robot. fleet: ground truth
    """

    def __init__(self, p: SimParams, world: World, engine: Engine) -> None:
        self.site = Site(world, engine, p.rates.physics_rate, p.world.seed)
        super().__init__(p.sensors, self.site, p.topics.localization == "truth")
        self.fleet = engine.fleet
        self.stamp_ns, self.due = 0, Due()  # of the last step on which something was due [ns]

    def of(self, sensor: str) -> Robots:
        """The robots for which a sensor is due and subscribed to."""
        return self.due.sensors.get(sensor, ())

    def reset(self, seed: int, spawns: Sequence[Pose2D]) -> None:
        """Set odometry to zero at the spawn poses, where robots are, and noise and moving obstacles to their start."""
        for sensor in self.by_name.values():
            sensor.reset(spawns)
        self.site.episode.seed, self.site.episode.step = seed, 0
        self.site.scanners.move(0.0)

    def change_world(self, world: World) -> None:
        """Replace the world."""
        self.close()
        self.site.world = world
        self.site.scanners.change_world(world)
        self.site.scanners.move(self.site.time)

    def close(self) -> None:
        """Free what the sensors hold."""
        for sensor in self.by_name.values():
            sensor.close()
