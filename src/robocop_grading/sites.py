"""Where the scenarios of a plan take place: each at a site of its own, in one world."""

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, compose3, lifted
from aro_robocop_goto_as.shapes import Plane
from aro_robocop_goto_as.world.model import Obstacle, World

from .plan import HEIGHT, MAX_OFFSET, Plan

SPACING = 2.0 * MAX_OFFSET  # [m] between the sites; more than twice the lidar's range of 10 m
HEADING = 0.7  # [rad] yaw of each site's odom frame in the world, so that confusing the two frames has an effect


def site(index: int) -> Pose2D:
    """world_from_odom at the start of a scenario. Site 0 is the world's origin, where all frames coincide."""
    return Pose2D() if index == 0 else Pose2D(SPACING * index, -15.0, HEADING)


def world_of(plan: Plan) -> World:
    """The obstacles of all scenarios: those of the first one at site 1, and so on; site 0 is empty."""
    obstacles = [Obstacle("ground/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0)))]
    for index, scenario in enumerate(plan.scenarios, 1):
        for number, block in enumerate(scenario.obstacles):
            pose = compose3(lifted(site(index)), lifted(block.pose, HEIGHT / 2.0))
            obstacles.append(Obstacle(f"{scenario.name}/{number}/block", pose, block.geometry))
    return World("grading", tuple(obstacles), Pose2D(), (), "config/grading.yaml")
