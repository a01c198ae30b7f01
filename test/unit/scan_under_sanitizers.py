"""A program that scans all kinds of scenes with a sanitized library; a sanitizer's finding ends the process."""

import math
import sys

import numpy as np
from reference_beams import cut_of

from aro_robocop_goto_as import compiled
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.grid_index import Tiles
from aro_robocop_goto_as.raycast.scene import Plane, Scene

FANS = [
    (0.0, 6.28319 / 359, 360),
    (-math.pi, math.pi / 180, 361),
    (-9.0, 0.1, 190),
    (1.0, 0.05, 20),
    (3.0, 1.0, 1),
    (0.0, 1e-300, 3),
    (0.0, 1e-9, 50),
    (-1e15, 5.0, 7),
]
PLACES = [0.0, 0.25, -1.0, 2.0, 1e-300, -1e-12, 50.0, 1e9, -1e200, 1e308]


def scans(random: np.random.Generator, fan: Fan) -> None:
    """Scan random scenes with difficult geometry, with and without a grid index."""
    count, owned = int(random.integers(0, 60)), int(random.integers(0, 9))
    walls = random.choice([random.integers(-8, 8, (count, 2, 2)) / 4.0, random.uniform(-9, 9, (count, 2, 2))])
    walls[: count // 10] *= 10.0 ** random.integers(-300, 150)
    posts = np.abs(random.normal(0.0, 2.0, (int(random.integers(0, 5)), 3))) - [1.0, 1.0, 0.0]
    robots = int(random.integers(1, 6))
    owners = np.sort(random.integers(0, robots, owned))
    cuts = [cut_of(walls, posts), cut_of(walls, posts)]
    cuts[1].tiles = Tiles(cuts[1].segments)
    planes = [Plane(cut, random.uniform(0.0, 0.5, (owned, 3)), owners) for cut in cuts]
    scene = Scene(planes, random.integers(0, 2, robots).tolist(), random.normal(0.0, 0.1, (robots, 3)))
    scene.footprints[:] = random.choice(PLACES, (robots, 3))
    scene.footprints[0] = random.uniform(-4.0, 4.0, 3)
    for max_range in (0.0, 3.5, 1e300, math.inf):
        distances = fan.scan(scene, random.permutation(robots).tolist(), max_range)
        assert ((distances >= 0.0) & (distances <= max_range) | np.isinf(distances)).all()


def main() -> None:
    """Option --beyond: read past the end of an array on purpose."""
    path = sys.argv[1]
    compiled.find = lambda name, folders=None: path
    if "--beyond" in sys.argv:
        plane = Plane(cut_of(np.ones((400, 2, 2)), np.zeros((0, 3))))
        plane.struct.n_segments += 1
        Fan(*FANS[0]).scan(Scene([plane], [0], np.zeros((1, 3))), [0])
    random = np.random.default_rng(0)
    fans = [Fan(*fan) for fan in FANS]
    for _ in range(25):
        for fan in fans:
            scans(random, fan)
    print("sound")


if __name__ == "__main__":
    main()
