"""Gazebo's services as submissions find them: they may look at the world, but change nothing."""

from ...errors import WorldError
from ...geometry import Pose2D, Pose3D
from ...ros.sim.gazebo_services import GazeboControl, GazeboServices
from ...simulation.loop import SimulationLoop

REFUSAL = "the judge decides where the robot and the models of the world are"


class _ReadOnly(GazeboControl):
    """Pausing and resetting do nothing; other changes are refused."""

    def __init__(self) -> None:
        """There is nothing to control."""

    def set_paused(self, paused: bool) -> None:
        """Simulated time is the judge's."""

    def reset(self) -> None:
        """Simulated time is the judge's."""

    def place(self, robot: int, pose: Pose2D) -> None:
        """Refused."""
        raise WorldError(REFUSAL)

    def move(self, model: str, pose: Pose3D) -> None:
        """Refused."""
        raise WorldError(REFUSAL)

    def spawn(self, name: str, xml: str, pose: Pose3D) -> str:
        """Refused."""
        raise WorldError(REFUSAL)

    def delete(self, name: str) -> str:
        """Refused."""
        raise WorldError(REFUSAL)


def serve(loop: SimulationLoop) -> None:
    """Offer the services."""
    GazeboServices(loop, _ReadOnly())
