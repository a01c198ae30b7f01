"""Steps a case without ROS: core.py CASE SECONDS CHECKOUT, in simulated seconds, with the files of a checkout."""

import os
import sys

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.robot.catalog import load_model
from aro_robocop_goto_as.simulation.factory import make_simulator, robots_from
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.load import find_world, load_world
from bench.cases import VELOCITY, Case


def main(case: str, seconds: float, checkout: str) -> None:
    """All robots drive in circles, with a subscriber to each one's scan and odometry."""
    p = SimParams.of(**Case(*case.split(":")).params(0.0))
    world = load_world(find_world(p.world.world, os.path.join(checkout, "worlds")))
    simulator = make_simulator(p, world, robots_from(p.robots, world, lambda model: load_model(model, checkout)))
    robots = range(len(simulator.robots))
    for robot in robots:
        simulator.command(Twist2D(*VELOCITY), robot)
    subscriptions, end = {"scan": robots, "odom": robots}, round(seconds * simulator.rate)
    while simulator.steps < end:
        simulator.advance(subscriptions, end - simulator.steps)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
