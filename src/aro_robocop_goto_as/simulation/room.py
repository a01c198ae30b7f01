"""Whether there is room for a robot at a pose."""

import math
from typing import Sequence

from ..errors import PlaceError
from ..geometry import Pose2D
from ..raycast.surroundings import Surroundings, body_heights
from ..robot.fleet import Fleet
from ..robot.model import RobotSpec
from ..world.model import World


def require_room(
    world: World, time: float, robots: Sequence[RobotSpec], fleet: Fleet, pose: Pose2D, robot: int
) -> None:
    """PlaceError, naming what is in the way, if a robot's footprint at a pose overlaps an obstacle or another robot.

    `time` [s] is that of moving obstacles.
    """
    x, y, radii = pose.x, pose.y, fleet.radii.tolist()
    nearest = Surroundings(world, body_heights(robots[robot].model), time).nearest(x, y)
    if nearest.distance < radii[robot]:
        raise PlaceError(
            f"x {x:.3f} y {y:.3f} is {nearest.distance:.3f} m from '{nearest.name}', expected at least the robot's "
            f"radius of {radii[robot]:g} m"
        )
    for index, other in enumerate(robots):
        stands = fleet.pose(index)
        distance, least = math.hypot(stands.x - x, stands.y - y), radii[robot] + radii[index]
        if index != robot and distance < least:
            raise PlaceError(
                f"x {x:.3f} y {y:.3f} is {distance:.3f} m from robot '{other.name}', expected at least {least:g} m"
            )
