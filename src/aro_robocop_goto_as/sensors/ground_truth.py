"""The true poses and velocities of the robots, which are rows of the fleet."""

from dataclasses import dataclass

from ..param_loading import parameter
from .sensor import Sensor, Site

GROUND_TRUTH = "ground_truth"


@dataclass(frozen=True)
class TruthParams:
    """Whether the truth is published, and how often."""

    ground_truth: bool = parameter(True, about="publish ground_truth_odom")
    ground_truth_rate: int = parameter(30, low=1, about="[Hz] of ground_truth_odom")


class GroundTruth(Sensor):
    """Has no rows of its own."""

    name = GROUND_TRUTH

    def __init__(self, params: TruthParams, site: Site) -> None:
        super().__init__(site, params.ground_truth_rate if params.ground_truth else 0)
