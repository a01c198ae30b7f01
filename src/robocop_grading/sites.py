"""Where scenarios take place: a server's all at one pose in the world, so that the pose reveals none of them."""

from typing import Sequence

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, compose3, lifted
from aro_robocop_goto_as.shapes import Plane
from aro_robocop_goto_as.world.model import Obstacle, World

from .scenarios import HEIGHT, Block

ORIGIN = Pose2D()  # world_from_odom at a scenario's start where all frames coincide
SITE = Pose2D(40.0, -15.0, 0.7)  # likewise, where confusing two frames has an effect


def world_of(site: Pose2D, blocks: Sequence[Block] = ()) -> World:
    """The obstacles of one scenario around its site."""
    obstacles = [Obstacle("ground/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0)))]
    for number, block in enumerate(blocks):
        pose = compose3(lifted(site), lifted(block.pose, HEIGHT / 2.0))
        obstacles.append(Obstacle(f"block/{number}/collision", pose, block.geometry))
    return World("grading", tuple(obstacles), Pose2D(), (), "config/grading.yaml")
