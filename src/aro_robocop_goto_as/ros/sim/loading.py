"""Loads the files that the parameters name, then makes the simulator; see simulation.factory."""

import logging
import os

import rospkg
import rospy

from ...errors import PlaceError, WorldError
from ...floor_plan.free_places import occupant
from ...names import PACKAGE
from ...robot.catalog import load_model
from ...simulation.factory import make_simulator, robots_from
from ...simulation.params import SimParams
from ...simulation.simulator import Simulator
from ...world.load import RANDOM, find_world, load_world
from ...world.model import World
from ..share import share


def make_random(seed: int) -> str:
    """Make a random world and write it to ROS's home folder; the file's path can be given as `world` again."""
    path = os.path.join(rospkg.get_ros_home(), f"random_{seed}.sdf")
    from ...world.random_maze import random_world

    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(random_world(seed))
    except OSError as error:
        raise WorldError(f"{path}: cannot write the random world: {error.strerror}") from error
    return path


def load_simulator(p: SimParams) -> Simulator:
    """The simulator for these parameters; RobocopError when the world, the robots or a place for them is missing."""
    package = share()
    logging.getLogger(PACKAGE).parent = logging.getLogger("rosout")  # to which rospy's own messages go
    path = (
        make_random(p.world.seed)
        if p.world.world == RANDOM
        else find_world(p.world.world, os.path.join(package, "worlds"))
    )
    world = load_world(path)
    simulator = make_simulator(p, world, robots_from(p.robots, world, lambda name: load_model(name, package)))
    _log(p, world, simulator)
    return simulator


def _log(p: SimParams, world: World, simulator: Simulator) -> None:
    if world.moving() and not p.world.moving:
        rospy.loginfo("world %s has moving obstacles, which are disabled; moving:=true enables them", world.name)
    rospy.loginfo("world %s from %s", world.name, world.path)
    first = simulator.robots[0].spawn
    is_elsewhere = not world.has_spawn and first != world.spawn
    if is_elsewhere and not p.robots.spawn.strip() and (p.robots.robots.strip() or "1").isdecimal():
        rospy.logwarn(
            "%s (%g, %g) is %s; spawning at the free pose (%.2f, %.2f); spawn:='X Y' chooses another one",
            "the saved robot's pose"
            if world.has_saved_robot
            else f"world {world.name} does not say where robots start, and",
            world.spawn.x,
            world.spawn.y,
            occupant(world, world.spawn, simulator.robots[0].model),
            first.x,
            first.y,
        )
    for robot in simulator.robots:
        rospy.loginfo(
            "robot %sat x %.2f y %.2f yaw %.2f",
            robot.name and robot.name + " ",
            robot.spawn.x,
            robot.spawn.y,
            robot.spawn.yaw,
        )
    if p.robots.spawn.strip() and len(simulator.robots) == 1:
        try:
            simulator.require_room(first)
        except PlaceError as error:
            rospy.logwarn("the robot starts where it has no room: %s", error)
    scan = p.sensors.lidar
    given = scan.given()
    if given:
        values = ", ".join(f"{name} {value:g}" for name, value in given.items())
        rospy.loginfo("scan_profile %s, with %s", scan.scan_profile, values)
    if world.approximated:
        rospy.logwarn(
            "different from %s, and what is left out is neither seen nor touched: %s",
            world.path,
            ", ".join(world.approximated),
        )
    if world.ignored:
        rospy.loginfo("ignored in %s: %s", world.path, ", ".join(world.ignored))
