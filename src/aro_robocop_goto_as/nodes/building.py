"""Parameters -> the simulator, from the files of this package or the user's."""

import os

import rospkg
import rospy

from ..errors import WorldError
from ..models import load_model
from ..params import SimParams
from ..random_world import random_world
from ..simulator import Simulator
from ..spawns import robots_from
from ..world import find_world, load_world

PACKAGE = "aro_robocop_goto_as"
RANDOM = "random"  # as `world`: one made from the seed


def make_random(seed: int) -> str:
    """Make a random world and leave it in ROS' home as a file, whose path can be given as `world` again."""
    path = os.path.join(rospkg.get_ros_home(), f"random_{seed}.sdf")
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(random_world(seed))
    except OSError as error:
        raise WorldError(f"{path}: can't write the random world: {error.strerror}") from error
    return path


def build_simulator(p: SimParams) -> Simulator:
    """The simulator for these parameters; RobocopError when world, robots or their places can't be had."""
    share = rospkg.RosPack().get_path(PACKAGE)
    path = make_random(p.seed) if p.world == RANDOM else find_world(p.world, os.path.join(share, "worlds"))
    world = load_world(path)
    if world.moving() and not p.moving:
        rospy.loginfo("what world %s can move stands still, unless moving:=true", world.name)
    return Simulator(p, world, robots_from(p, world, lambda name: load_model(name, share)))
