"""The true poses and velocities of the robots, which are rows of the fleet."""

from dataclasses import dataclass

from ..param_loading import parameter
from .sensor import MeasurementCalls, RateParams, RobotIndices, Sensor, SensorContext


@dataclass(frozen=True)
class TruthParams(RateParams):
    """Whether the truth is published, and how often."""

    ground_truth: bool = parameter(True, about="publish ground_truth_odom")
    ground_truth_rate: int = parameter(30, low=1, about="[Hz] of ground_truth_odom")


class GroundTruth(Sensor):
    """poses: (n, 3) world_from_footprint; twists: (n, 2) v [m/s], w [rad/s]; both are the fleet's own rows."""

    topic = "ground_truth_odom"

    def __init__(self, params: TruthParams, context: SensorContext) -> None:
        super().__init__(context, params.ground_truth_rate if params.ground_truth else 0)
        self.poses, self.twists = context.fleet.poses, context.fleet.twists

    def measurement_calls(self, _robots: RobotIndices) -> MeasurementCalls:
        """Nothing to do: the fleet's rows are up to date."""
        return MeasurementCalls([])
