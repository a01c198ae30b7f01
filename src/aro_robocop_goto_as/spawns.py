"""Parameters + World -> which robots there are and where each one starts."""

import heapq
import math
from typing import Callable, List, Set, Tuple

import numpy as np

from .errors import ParameterError
from .geometry import Pose2D, compose
from .params import SimParams
from .raycast import Fan
from .robot import RobotModel
from .simulator import RobotSpec
from .slice import Slice
from .world import World

FARTHEST = 1e6  # [m] from the origin: single-precision messages still tell centimetres there
SPACING = 0.5  # [m] between robots that are placed by themselves
CLEARANCE = 0.3  # [m] from each of those to the nearest obstacle
LOOK = Fan(0.0, math.pi / 36.0, 72)

Cell = Tuple[int, int]  # of the grid, (0, 0) at its origin


def robots_from(p: SimParams, world: World, load: Callable[[str], RobotModel]) -> List[RobotSpec]:
    """The robots that the parameters ask for, of models that `load` gets by their names.

    `robots` empty: one, without a name, at `spawn`. A number: robot_1 to robot_N, on free places around `spawn`.
    Else a list 'NAME[:MODEL] X Y [YAW]; NAME[:MODEL] X Y [YAW]; ...' [m, rad], of `model` where it names none.
    ParameterError says what can't be honoured.
    """
    model = load(p.model)
    text = p.robots.strip()
    spawn = parse_spawn(p.spawn, world.spawn)
    if not text:
        return [RobotSpec("", model, spawn)]
    if text.isdigit():
        count = int(text)
        if count < 1:
            raise ParameterError("robots: expected at least 1")
        names = [f"robot_{i}" for i in range(1, count + 1)]
        return [RobotSpec(name, model, pose) for name, pose in zip(names, free_places(world, spawn, count))]
    return [RobotSpec(name, load(kind) if kind else model, pose) for name, kind, pose in _parse_list(text)]


def parse_spawn(text: str, default: Pose2D, parameter: str = "spawn") -> Pose2D:
    """A pose from 'x y' or 'x y yaw' [m, rad]; the empty text means the default. ParameterError otherwise."""
    if not text.strip():
        return default
    try:
        numbers = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(abs(number) <= FARTHEST for number in numbers):
        raise ParameterError(f"{parameter}: expected 'x y' or 'x y yaw' in metres and radians, numbers within "
                             f"+-{FARTHEST:g}, got {text!r}")
    return Pose2D(*numbers)


def _parse_list(text: str) -> List[Tuple[str, str, Pose2D]]:
    """Name, model's name (empty: none given) and place of each robot."""
    found: List[Tuple[str, str, Pose2D]] = []
    for entry in (part.strip() for part in text.split(";")):
        head, _, rest = entry.partition(" ")
        name, colon, kind = head.partition(":")
        if not (name.isidentifier() and name.isascii()) or bool(colon) != bool(kind) or not rest.strip():
            raise ParameterError(f"robots: expected 'NAME X Y [YAW]; ...' or 'NAME:MODEL X Y [YAW]; ...' with names of "
                                 f"letters, digits and _, got {entry!r}")
        if name in [other for other, _, _ in found]:
            raise ParameterError(f"robots: the name {name!r} is given twice")
        found.append((name, kind, parse_spawn(rest, Pose2D(), f"robots: {name}")))
    return found


def free_places(world: World, around: Pose2D, count: int) -> List[Pose2D]:
    """Poses on a grid around one, away from obstacles, each reached from there over free ones; the same every time.

    ParameterError when there is no room for as many.
    """
    walls = Slice(world, 0.1)
    waiting: List[Tuple[int, Cell]] = [(0, (0, 0))]
    seen: Set[Cell] = {(0, 0)}
    places: List[Pose2D] = []
    while waiting and len(places) < count:
        _, cell = heapq.heappop(waiting)
        place = _pose(around, cell)
        places.append(place)
        for di, dj in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            neighbour = (cell[0] + di, cell[1] + dj)
            pose = _pose(around, neighbour)
            if neighbour not in seen and _is_free(pose, walls) and _in_sight(pose, place, walls):
                seen.add(neighbour)
                heapq.heappush(waiting, (neighbour[0] ** 2 + neighbour[1] ** 2, neighbour))
    if len(places) < count:
        raise ParameterError(f"robots: world {world.name!r} has room for {len(places)} around its spawn, "
                             f"{count} were asked for")
    return places


def _pose(around: Pose2D, cell: Cell) -> Pose2D:
    return compose(around, Pose2D(cell[0] * SPACING, cell[1] * SPACING))


def _is_free(place: Pose2D, walls: Slice) -> bool:
    return bool(LOOK.cast(np.array([[place.x, place.y, 0.0]]), walls, reach=CLEARANCE).min() >= CLEARANCE)


def _in_sight(place: Pose2D, other: Pose2D, walls: Slice) -> bool:
    """Whether nothing stands between two places: so no robot is put outside a closed room, or inside a wall."""
    dx, dy = other.x - place.x, other.y - place.y
    away = math.hypot(dx, dy)
    ray = Fan(math.atan2(dy, dx), 1.0, 1).cast(np.array([[place.x, place.y, 0.0]]), walls, reach=away)[0, 0]
    return bool(ray > away)
