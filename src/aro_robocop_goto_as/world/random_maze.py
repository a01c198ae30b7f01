"""Generate the SDF of a random maze with clutter; a robot can reach every cell.

Lanes are 0.45 m wide, 0.225 m to each side of their centre line. A Burger, of 0.105 m radius, has room to spare; a
Waffle, of 0.22 m, has none: 5 mm to each side.
"""

import itertools
import random
from typing import Dict, Iterator, List, Set, Tuple

SIZES = (4, 7)  # minimum and maximum number of cells per side; a cell is 1 m x 1 m, centred at whole metres
THICKNESS, HEIGHT = 0.15, 0.5  # [m] of walls, as in the other worlds
LOOP_SHARE = 0.15  # of the inner walls, removed to create alternative routes
CLUTTER_SHARE = 0.5  # of the cells, with an object in one corner
CLUTTER_WIDTH = (0.08, 0.2)  # [m] minimum and maximum
LANE = 1.0 - THICKNESS - 2.0 * CLUTTER_WIDTH[1]  # [m] free width across each cell, whichever corners are cluttered

Cell = Tuple[int, int]  # column, row
Wall = Tuple[Cell, Cell]  # between two neighbouring cells, the lower one first; one of them may be outside the maze


def random_world(seed: int) -> str:
    """The text of a world file; equal seeds give equal texts."""
    rng = random.Random(seed)
    columns, rows = rng.randint(*SIZES), rng.randint(*SIZES)
    cells = [(x, y) for x in range(columns) for y in range(rows)]
    walls = _maze(rng, set(cells))
    collisions = [_wall(f"wall_{i}", *run) for i, run in enumerate(_runs(walls))]
    numbers = itertools.count()
    collisions += [
        _clutter(f"thing_{next(numbers)}", cell, rng)
        for cell in cells
        if cell != (0, 0) and rng.random() < CLUTTER_SHARE
    ]
    return _FILE.format(
        seed=seed,
        columns=columns,
        rows=rows,
        goals=" ".join(f"({x}, {y})" for x, y in cells[1:]),
        collisions="".join(collisions),
        half_lane=round(LANE / 2.0, 3),
        yaw="0" if ((0, 0), (1, 0)) not in walls else "1.5708",
    )


def _maze(rng: random.Random, cells: Set[Cell]) -> Set[Wall]:
    """Walls that leave a path between any two cells: a depth-first search removes them, then loops are opened."""
    walls = {_between(cell, neighbour) for cell in cells for neighbour in _neighbours(cell)}
    trail, seen = [(0, 0)], {(0, 0)}
    while trail:
        fresh = [cell for cell in _neighbours(trail[-1]) if cell in cells and cell not in seen]
        if not fresh:
            trail.pop()
            continue
        step = rng.choice(fresh)
        walls.remove(_between(trail[-1], step))
        seen.add(step)
        trail.append(step)
    inner = sorted(wall for wall in walls if cells.issuperset(wall))
    return walls - set(rng.sample(inner, int(LOOP_SHARE * len(inner))))


def _neighbours(cell: Cell) -> List[Cell]:
    x, y = cell
    return [(x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)]


def _between(a: Cell, b: Cell) -> Wall:
    return (a, b) if a < b else (b, a)


def _runs(walls: Set[Wall]) -> Iterator[Tuple[int, float, float, float]]:
    """Adjoining collinear walls merged: (axis along the run, coordinate across it, start, end) [m]."""
    lines: Dict[Tuple[int, float], List[int]] = {}
    for (x, y), (other_x, _) in sorted(walls):
        axis, across, along = (1, x + 0.5, y) if other_x > x else (0, y + 0.5, x)
        lines.setdefault((axis, across), []).append(along)
    for (axis, across), places in sorted(lines.items()):
        for _, group in itertools.groupby(enumerate(sorted(places)), lambda item: item[1] - item[0]):
            run = [place for _, place in group]
            yield axis, across, run[0] - 0.5, run[-1] + 0.5


def _wall(name: str, axis: int, across: float, start: float, end: float) -> str:
    middle, length = (start + end) / 2.0, end - start + THICKNESS
    x, y, width, depth = (middle, across, length, THICKNESS) if axis == 0 else (across, middle, THICKNESS, length)
    return _collision(name, x, y, HEIGHT, f"<box><size>{width:g} {depth:g} {HEIGHT:g}</size></box>")


def _clutter(name: str, cell: Cell, rng: random.Random) -> str:
    """A box or a pillar in a corner of a cell, touching both walls."""
    width = round(rng.uniform(*CLUTTER_WIDTH), 3)
    away = 0.5 - THICKNESS / 2.0 - width / 2.0
    x, y = (centre + rng.choice((-away, away)) for centre in cell)
    height = round(rng.uniform(0.25, HEIGHT), 3)
    box = f"<box><size>{width:g} {width:g} {height:g}</size></box>"
    pillar = f"<cylinder><radius>{width / 2.0:g}</radius><length>{height:g}</length></cylinder>"
    return _collision(name, x, y, height, box if rng.random() < 0.5 else pillar)


def _collision(name: str, x: float, y: float, height: float, shape: str) -> str:
    """A shape that stands on the ground."""
    return f"""
        <collision name="{name}">
          <pose>{x:g} {y:g} {height / 2.0:g} 0 0 0</pose>
          <geometry>{shape}</geometry>
        </collision>"""


_FILE = """<?xml version="1.0" encoding="UTF-8"?>
<!--
  A random maze, made from seed {seed}: {columns} x {rows} cells of 1 m, walls 0.15 m thick, 0.5 m high. A robot that
  keeps to the middle of the lanes has {half_lane:g} m free to each side and reaches every cell.

  Free goals: {goals}
-->
<sdf version="1.7">
  <world name="random_{seed}">
    <frame name="robot_spawn">
      <pose>0 0 0 0 0 {yaw}</pose>
    </frame>
    <model name="maze">
      <static>true</static>
      <link name="link">{collisions}
      </link>
    </model>
  </world>
</sdf>
"""
