"""Parameters -> the simulator, with world, engine and robots from the files of this package or of the user."""

import os

import rospkg
import rospy

from ...errors import WorldError
from ...params import SimParams
from ...robot.catalog import load_model
from ...simulation.factory import make_simulator
from ...simulation.robots import robots_from
from ...simulation.simulator import Simulator
from ...world.load import find_world, load_world
from ...world.model import World
from ...world.random_maze import random_world
from .robot_topics import MessageConfig

PACKAGE = "aro_robocop_goto_as"
RANDOM = "random"  # the world that is made from the seed


def make_random(seed: int) -> str:
    """Make a random world and write it to ROS's home folder; the file's path can be given as `world` again."""
    path = os.path.join(rospkg.get_ros_home(), f"random_{seed}.sdf")
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(random_world(seed))
    except OSError as error:
        raise WorldError(f"{path}: cannot write the random world: {error.strerror}") from error
    return path


def message_config(p: SimParams) -> MessageConfig:
    """The parameters of the messages."""
    return MessageConfig(p.frames(), p.topics(), p.rates(), p.scanner().spec, p.imu_noise())


def build_simulator(p: SimParams) -> Simulator:
    """The simulator for these parameters; RobocopError when the world, the robots or a place for them is missing."""
    share = rospkg.RosPack().get_path(PACKAGE)
    path = make_random(p.seed) if p.world == RANDOM else find_world(p.world, os.path.join(share, "worlds"))
    world = load_world(path)
    simulator = make_simulator(p, world, robots_from(p.spawn_params(), world, lambda name: load_model(name, share)))
    _log(p, world, simulator)
    return simulator


def _log(p: SimParams, world: World, simulator: Simulator) -> None:
    if world.moving() and not p.moving:
        rospy.loginfo("world %s has moving obstacles, which are disabled; moving:=true enables them", world.name)
    rospy.loginfo("world %s from %s", world.name, world.path)
    first = simulator.robots[0].spawn
    is_elsewhere = not world.has_spawn and (first.x, first.y) != (0.0, 0.0)
    if is_elsewhere and not p.spawn.strip() and (p.robots.strip() or "1").isdigit():
        rospy.logwarn(
            "world %s does not say where robots start, and at x 0 y 0 there is no room: x %.2f y %.2f is the nearest "
            "place that has; spawn:='X Y' chooses another one",
            world.name,
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
    given = p.given_scan()
    if given:
        values = ", ".join(f"{name} {value:g}" for name, value in given.items())
        rospy.loginfo("scan_profile %s, with %s", p.scan_profile, values)
    if world.ignored:
        rospy.loginfo("not simulated from that file: %s", ", ".join(world.ignored))
