"""The sonar: an ultrasonic range finder low on the front of each robot, off by default.

It measures the nearest return within its cone, of which a few level beams are cast: it detects low obstacles that the
lidar looks over, but not the floor. Its figures are those of the HC-SR04's data sheet (ElecFreaks): 0.02 to 4 m, a
measuring angle of 15 degrees, an accuracy of 3 mm. As for the lidars, the accuracy is taken as two sigma of the noise.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Dict

import numpy as np

from ..geometry import Pose3D
from ..param_loading import parameter
from ..raycast.beams import Beams
from ..robot.model import RobotModel
from ..shapes import Box, Cylinder
from .sensor import MeasurementCalls, RateParams, RobotIndices, Sensor, SensorContext

SONAR = "sonar"
HEIGHT = 0.05  # [m] above the floor
BEAMS = 7  # of a cone of 15 degrees: at 1 m they are 0.04 m apart


@dataclass(frozen=True)
class SonarParams(RateParams):
    """Whether there is a sonar, its noise, and how often it measures."""

    sonar: bool = parameter(False, about="whether each robot has one: an ultrasonic range finder low on the front")
    sonar_rate: int = parameter(10, low=1, about="[Hz] of sonar")
    sonar_noise: float = parameter(
        0.0015, 0.0, 100.0, "[m] standard deviation; two of it are the HC-SR04's accuracy of 3 mm"
    )

    def rates(self) -> Dict[str, int]:
        """The rate [Hz]; none without a sonar."""
        return super().rates() if self.sonar else {}


def mount(model: RobotModel) -> Pose3D:
    """base_from_sonar: at the foremost point of the model's boxes and cylinders, looking ahead."""
    front = 0.0
    for collision in model.collisions:
        shape = collision.geometry
        if isinstance(shape, (Box, Cylinder)):
            reach = shape.size[0] / 2.0 if isinstance(shape, Box) else shape.radius
            front = max(front, collision.pose.position[0] + reach)
    return Pose3D((front, 0.0, HEIGHT - model.footprint_from_base.position[2]))


class Sonar(Sensor):
    """ranges: (n, 1) [m] in sonar_link, along its x axis; too near is -inf, no return is +inf (REP-117)."""

    topic, frame = SONAR, "sonar_link"
    angle = math.radians(15.0)  # of the whole cone
    range_min, range_max = 0.02, 4.0  # [m]
    radiation_type = 0  # sensor_msgs/Range: ULTRASOUND
    first_stream = 2**33  # of the noise of the first robot's sonar, the next one's is one more; see sensor.py

    def __init__(self, params: SonarParams, context: SensorContext) -> None:
        super().__init__(context, params.sonar_rate if params.sonar else 0)
        self.mounts = tuple(mount(model) for model in context.models)
        self.ranges = np.zeros((len(context.fleet), 1))
        self._noise = params.sonar_noise
        self._beams = Beams(-self.angle / 2.0, self.angle / (BEAMS - 1), BEAMS)
        self._distances = np.zeros((len(context.fleet), BEAMS))

    def measurement_calls(self, robots: RobotIndices) -> MeasurementCalls:
        """Cast these robots' beams, and take the nearest return of each robot."""
        cast = self._beams.casting(self.context.sections.scene(self.mounts), robots, self.range_max, self._distances)
        return MeasurementCalls([cast, partial(self.measure, robots)])

    def measure(self, robots: RobotIndices) -> None:
        """Turn the distances along these robots' beams into ranges."""
        for robot in robots:
            noise = self.context.noise.stream(self.first_stream + robot).normal(0.0, self._noise)
            distance = self._distances[robot].min() + noise
            is_near, is_far = distance < self.range_min, distance > self.range_max
            self.ranges[robot] = -math.inf if is_near else math.inf if is_far else distance
