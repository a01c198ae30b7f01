"""Writes the worlds of cases that are not in worlds/bench.sdf."""

from pathlib import Path

import numpy as np

from ..ros.share import share
from .cases import Case, positions

MOVING = 20  # pillars, which move to and fro by 0.2 m, on the places next to the robot's
PILLAR = """<model name="moving_{number}"><static>true</static><pose>{x} {y} 0 0 0 0</pose>
<plugin name="patrol" filename="robocop_motion"><waypoint>2 0 0.2</waypoint><waypoint>4 0 0</waypoint></plugin>
<link name="link"><collision name="pillar"><pose>0 0 0.25 0 0 0</pose>
<geometry><cylinder><radius>0.1</radius><length>0.5</length></cylinder></geometry></collision></link></model>
"""
CELLS = 4000  # of the map, in each direction
MAP = """image: map.pgm
resolution: 0.05
origin: [-100.0, -100.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def world_of(case: Case, directory: Path) -> str:
    """The parameter `world` of a case; its files are written to the directory unless they are there."""
    moving, large_map = directory / "moving.sdf", directory / "map.yaml"
    if case.kind == "moving":
        hall = Path(share(), "worlds", "bench.sdf").read_text()
        places = enumerate(positions()[1 : MOVING + 1])
        pillars = "".join(PILLAR.format(number=number, x=x, y=y) for number, (x, y) in places)
        moving.write_text(hall.replace("</world>", pillars + "</world>"))
        return str(moving)
    if case.kind == "map":
        if not large_map.exists():
            cells = np.full((CELLS, CELLS), 254, np.uint8)  # free, but for 2,500 square pillars: 10,000 walls
            cells.reshape(50, 80, 50, 80)[:, 35:45, :, 35:45] = 0  # 0.5 m wide, 4 m apart
            large_map.with_suffix(".pgm").write_bytes(b"P5 %d %d 255\n" % cells.shape + cells.tobytes())
            large_map.write_text(MAP)
        return str(large_map)
    return "bench"
