"""Whether there is room for a robot at a pose."""

import math
from typing import Callable, Sequence

from ..errors import PlaceError
from ..geometry import Pose2D
from ..raycast.surroundings import Surroundings, body_heights
from ..robot.model import RobotSpec
from ..world.model import World


def require_room(
    world: World,
    time: float,
    robots: Sequence[RobotSpec],
    poses: Sequence[Pose2D],
    radius_of: Callable[[int], float],
    pose: Pose2D,
    robot: int,
) -> None:
    """PlaceError, naming what is in the way, if a robot's footprint at a pose overlaps an obstacle or another robot.

    `time` [s] is that of moving obstacles, `poses` are where the robots stand, `radius_of` gives their footprints [m].
    """
    x, y, radius = pose.x, pose.y, radius_of(robot)
    nearest = Surroundings(world, body_heights(robots[robot].model), time).nearest(x, y)
    if nearest.distance < radius:
        raise PlaceError(
            f"x {x:.3f} y {y:.3f} is {nearest.distance:.3f} m from '{nearest.name}', expected at least the robot's "
            f"radius of {radius:g} m"
        )
    for index, (other, stands) in enumerate(zip(robots, poses)):
        distance, least = math.hypot(stands.x - x, stands.y - y), radius + radius_of(index)
        if index != robot and distance < least:
            raise PlaceError(
                f"x {x:.3f} y {y:.3f} is {distance:.3f} m from robot '{other.name}', expected at least {least:g} m"
            )
