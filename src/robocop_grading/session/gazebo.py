"""Gazebo's services as submissions find them: they may look at the world, but change nothing."""

from aro_robocop_goto_as.ros.sim.gazebo_services import GazeboServices
from aro_robocop_goto_as.simulation.simulation import Simulation

REFUSAL = "the judge decides where the robot and the models of the world are"


def serve(simulation: Simulation) -> None:
    """Offer the services."""
    GazeboServices(simulation, None, REFUSAL)
