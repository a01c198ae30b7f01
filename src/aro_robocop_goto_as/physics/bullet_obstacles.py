"""The floor and the obstacles of a world as bodies in Bullet; obstacles within the ground are left out."""

from itertools import filterfalse
from typing import Dict, Iterator, List, Set, Tuple

from ..shapes import Plane
from ..world.ground import is_in_ground
from ..world.model import Obstacle, World
from .bullet_shapes import FLOOR, shapes_of
from .quiet_pybullet import pybullet

ROBOT_GROUP, WORLD_GROUP = 1, 2  # Bullet's collision filter bits; its rays are of group 1


class BulletObstacles:
    """floors: the bodies of planes."""

    def __init__(self, world: World, client: int) -> None:
        self._world, self._client = world, client
        self.floors: Set[int] = set()
        self._moving: List[Tuple[int, Obstacle]] = []  # body and obstacle
        self._bodies: Dict[str, List[int]] = {}  # by the name of the obstacle

    def fill(self) -> None:
        """Add all bodies to an empty Bullet world."""
        self.floors, self._moving, self._bodies = set(), [], {}
        for obstacle in (FLOOR, *filterfalse(is_in_ground, self._world.obstacles)):
            self._add(obstacle)

    def replace(self, world: World) -> None:
        """Replace the world; obstacles that are in both worlds are not touched."""
        before, now = set(map(id, self._world.obstacles)), set(map(id, world.obstacles))
        for obstacle in self._world.obstacles:
            if id(obstacle) not in now:
                self._remove(obstacle)
        for obstacle in filterfalse(is_in_ground, world.obstacles):
            if id(obstacle) not in before:
                self._add(obstacle)
        self._world = world

    def move(self, time: float) -> Iterator[Tuple[float, float]]:
        """Put the moving obstacles where they are at `time` [s], one by one; yield x, y [m] of each."""
        for body, obstacle in self._moving:
            pose = obstacle.at(time)
            pybullet.resetBasePositionAndOrientation(
                body, pose.position, pose.orientation, physicsClientId=self._client
            )
            yield pose.position[:2]

    def _remove(self, obstacle: Obstacle) -> None:
        bodies = self._bodies.pop(obstacle.name, [])
        for body in bodies:
            pybullet.removeBody(body, physicsClientId=self._client)
        self.floors.difference_update(bodies)
        self._moving = [(body, other) for body, other in self._moving if body not in bodies]

    def _add(self, obstacle: Obstacle) -> None:
        """One static body per shape; as rigid bodies, not multibodies, they cost 0.7 us less per step."""
        client = self._client
        for shape in shapes_of(obstacle.geometry, client):
            body = pybullet.createMultiBody(
                0.0,
                shape,
                basePosition=obstacle.pose.position,
                baseOrientation=obstacle.pose.orientation,
                useMaximalCoordinates=1,
                physicsClientId=client,
            )
            pybullet.changeDynamics(body, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
            # Without the world's own group, as Bullet would compare walls with the floor on every step.
            pybullet.setCollisionFilterGroupMask(body, -1, WORLD_GROUP, ROBOT_GROUP, physicsClientId=client)
            self._bodies.setdefault(obstacle.name, []).append(body)
            if isinstance(obstacle.geometry, Plane):
                self.floors.add(body)
            if obstacle.motion is not None:
                self._moving.append((body, obstacle))
