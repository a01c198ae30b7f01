"""Find free starting poses for one robot or several around one pose."""

import heapq
import math
from typing import Iterator, List, Optional, Set, Tuple

import numpy as np

from ..errors import ParameterError
from ..geometry import Pose2D, compose
from ..raycast.beams import Beams
from ..raycast.cross_section import CrossSection
from ..robot.model import RobotModel
from ..world.model import World
from .obstacle_distance import ObstacleDistance

HEIGHT = 0.1  # [m] of the cross-section
SPACING = 0.5  # [m] of the grid
CLEARANCE = 0.3  # [m] from a pose to the nearest obstacle
MIN_MARGIN = 0.02  # [m] from a robot's footprint to the nearest obstacle, where no place has CLEARANCE
SEARCHES = ((0.1, 3.0), (0.5, 30.0))  # spacing and reach [m] of the grids on which a place for one robot is sought

Cell = Tuple[int, int]  # of the grid; (0, 0) is the pose in the centre


class _Room:
    """Where in a world there is room for robots of a model, by the distance to the nearest obstacle.

    In the world of a grid map, there is no room in unknown cells and outside the map.
    """

    def __init__(self, world: World, model: RobotModel) -> None:
        self.min_distance = model.figures.footprint_radius + MIN_MARGIN
        self.world = world
        self._distance = ObstacleDistance(world, model.body_heights())

    def at(self, x: float, y: float) -> float:
        """The distance [m] from a point to the nearest obstacle; -inf where a robot may not start."""
        if self.world.occupancy is not None and not self.world.occupancy.is_known(x, y):
            return -math.inf
        return self._distance.nearest(x, y).distance


def occupant(world: World, pose: Pose2D, model: RobotModel) -> str:
    """The obstacle, or unknown cell of a map, that takes the room at a pose, in words that follow "is"."""
    if world.occupancy is not None and not world.occupancy.is_known(pose.x, pose.y):
        return "unknown in the map"
    return f"occupied by '{ObstacleDistance(world, model.body_heights()).nearest(pose.x, pose.y).name}'"


def free_place(world: World, around: Pose2D, model: RobotModel) -> Pose2D:
    """The pose itself if a robot's footprint has room there; else, of equal yaw, the nearest pose of a grid that is
    CLEARANCE away from all obstacles, or, if there is none, the nearest one where the footprint has room.

    In the world of a map, the grid is laid around the free cell nearest to the pose. ParameterError if there is none.
    """
    return _place(_Room(world, model), around)


def _place(room: _Room, around: Pose2D) -> Pose2D:
    world = room.world
    if room.at(around.x, around.y) >= room.min_distance:
        return around
    centre = (around.x, around.y) if world.occupancy is None else world.occupancy.nearest_free(around.x, around.y)
    fallback: Optional[Pose2D] = None  # the nearest place with less than CLEARANCE
    for spacing, reach in SEARCHES:
        for x, y in _outwards(centre, spacing, reach):
            distance = room.at(x, y)
            if distance >= CLEARANCE:
                return Pose2D(x, y, around.yaw)
            if fallback is None and distance >= room.min_distance:
                fallback = Pose2D(x, y, around.yaw)
    if fallback is not None:
        return fallback
    raise ParameterError(
        f"spawn: world {world.name!r} has no room for a robot within {SEARCHES[-1][1]:g} m of x {around.x:g} "
        f"y {around.y:g}; give a spawn elsewhere"
    )


def _outwards(centre: Tuple[float, float], spacing: float, reach: float) -> Iterator[Tuple[float, float]]:
    """The points of a grid around a point [m], nearest first."""
    count = round(reach / spacing)
    cells = [(i * i + j * j, i, j) for i in range(-count, count + 1) for j in range(-count, count + 1)]
    for _, i, j in sorted(cells):
        yield centre[0] + i * spacing, centre[1] + j * spacing


def free_places(world: World, around: Pose2D, count: int, model: RobotModel) -> List[Pose2D]:
    """Poses on a grid, nearest to the centre first, clear of obstacles and connected to the centre by free grid edges.

    The centre is free_place of the given pose. If there are too few places with CLEARANCE, places where just the
    footprint has room count as well. The places depend on the arguments only. ParameterError if there are fewer than
    `count`.
    """
    section, room = CrossSection(world, HEIGHT), _Room(world, model)
    centre = _place(room, around)
    places: List[Pose2D] = []
    for clearance in (CLEARANCE, room.min_distance):
        places = _connected_places(section, room, centre, count, clearance)
        if len(places) >= count:
            return places
    raise ParameterError(
        f"robots: world {world.name!r} has room for {len(places)} around its spawn, {count} were requested"
    )


def _connected_places(section: CrossSection, room: _Room, centre: Pose2D, count: int, clearance: float) -> List[Pose2D]:
    """At most `count` places that are at least `clearance` [m] from all obstacles, the centre among them."""
    waiting: List[Tuple[int, Cell]] = [(0, (0, 0))]
    seen: Set[Cell] = {(0, 0)}
    places: List[Pose2D] = []
    while waiting and len(places) < count:
        _, cell = heapq.heappop(waiting)
        place = _pose(centre, cell)
        places.append(place)
        for di, dj in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            neighbour = (cell[0] + di, cell[1] + dj)
            pose = _pose(centre, neighbour)
            is_clear = neighbour not in seen and room.at(pose.x, pose.y) >= clearance
            if is_clear and _is_visible(pose, place, section):
                seen.add(neighbour)
                heapq.heappush(waiting, (neighbour[0] ** 2 + neighbour[1] ** 2, neighbour))
    return places


def _pose(centre: Pose2D, cell: Cell) -> Pose2D:
    return compose(centre, Pose2D(cell[0] * SPACING, cell[1] * SPACING))


def _is_visible(pose: Pose2D, other: Pose2D, section: CrossSection) -> bool:
    """Return whether no wall separates two poses, so that no robot starts outside a closed room or inside a wall."""
    dx, dy = other.x - pose.x, other.y - pose.y
    away = math.hypot(dx, dy)
    ray = Beams(math.atan2(dy, dx), 1.0, 1).cast(np.array([[pose.x, pose.y, 0.0]]), section, reach=away)[0, 0]
    return bool(ray > away)
