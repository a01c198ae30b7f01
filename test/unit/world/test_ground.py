"""Robots stand on what is flat, large and low, at its height, with either drive."""

import math

import pytest
import trimesh
from sdf_files import collision, model, world_file
from support import driven

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.sensors.lidar import SCAN
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.world.load import load_world

PLANE = "<include><uri>model://ground_plane</uri></include>"


def box(x, y, z):
    return f"<box><size>{x} {y} {z}</size></box>"


def slab(shape=None, z=0.0, name="asphalt", at=(0.0, 0.0), turn="0 0 0.3"):
    pose = f"<pose>{at[0]} {at[1]} {z} {turn}</pose>"
    return model(collision(shape or box(20, 20, 0.1)), name, pose)


GROUNDS = {  # case: (body of the world, height of the ground [m])
    "slab on a ground plane": (PLANE + slab(), 0.05),
    "slab alone, beside the origin": (slab(at=(30.0, 0.0)), 0.05),
    "slab beside the origin of a ground plane": (PLANE + slab(at=(30.0, 0.0)), 0.0),
    "higher of two slabs": (slab() + slab(box(6, 5, 0.3), name="pad"), 0.15),
    "four tiles that meet at the origin": (
        "".join(slab(box(10, 10, 0.1), 0.0, f"tile {x} {y}", (x, y), "0 0 0") for x in (-5, 5) for y in (-5, 5)),
        0.05,
    ),
    "round slab": (slab("<cylinder><radius>4</radius><length>0.1</length></cylinder>"), 0.05),
    "block sunk into the ground": (slab(box(9, 9, 2), z=-0.9), 0.1),
    "raised ground plane": (PLANE.replace("</uri>", "</uri><pose>0 0 0.1 0 0 0</pose>"), 0.1),
    "sunken ground plane": (PLANE.replace("</uri>", "</uri><pose>0 0 -0.1 0 0 0</pose>"), 0.0),
    "too high": (PLANE + slab(box(20, 20, 0.5)), 0.0),
    "too small": (PLANE + slab(box(20, 2, 0.1)), 0.0),
    "turned over": (PLANE + slab(turn="3.141592653589793 0 0.3"), 0.05),
    "tilted by as little as a file's digits": (PLANE + slab(turn="0 1e-4 0"), 0.051),
    "not level": (PLANE + slab(turn="0 0.02 0"), 0.0),
    "under the spawn, not the origin": (
        f'{PLANE}<frame name="robot_spawn"><pose>30 1 0.05 0 0 0</pose></frame>{slab(at=(30.0, 0.0))}',
        0.05,
    ),
}


@pytest.mark.parametrize(("body", "height"), GROUNDS.values(), ids=GROUNDS)
def test_ground_is_what_is_flat_large_and_low_under_the_spawn(tmp_path, body, height):
    assert load_world(world_file(tmp_path, body)).ground == pytest.approx(height)


@pytest.mark.parametrize("drive_by", ["wheels", "kinematic"])
def test_robot_drives_and_scans_on_a_slab_as_on_the_floor(tmp_path, burger, drive_by):
    seen = {}
    for name, body, height in (("floor", PLANE, 0.175), ("slab", PLANE + slab(), 0.225)):
        # A shelf from 0.15 to 0.20 m above the ground: a scanner at 0.182 m sees it, 5 cm lower it would not.
        shelf = slab(box(1, 20, 0.05), height, "shelf", (2.0, 0.0), "0 0 0")
        world = load_world(world_file(tmp_path / name, body + shelf))
        p = SimParams.of(drive=drive_by, scan_profile="ideal")
        sim = make_simulator(p, world, [RobotSpec("", burger, world.spawn)])
        driven(sim, Twist2D(0.2, 0.3), 1.0, [SCAN])
        assert not sim.touching() and not sim.newly_placed_in_contact()
        seen[name] = (*sim.world_from_footprint(), *sim.sensors.lidar.ranges[0])
        sim.close()
    assert seen["slab"] == pytest.approx(seen["floor"], abs=1e-9)
    assert math.hypot(*seen["slab"][:2]) > 0.1 and min(seen["slab"][3:]) < 1.5


def test_mesh_is_ground_if_its_top_fills_its_rectangle(tmp_path):
    floor, walls = trimesh.creation.box((10, 10, 0.1)), trimesh.creation.annulus(4.9, 5.0, 0.1)
    for name, mesh in (("floor", floor), ("walls", walls)):
        mesh.export(str(tmp_path / f"{name}.stl"))
    heights = {}
    for name in ("floor", "walls"):
        for turn in ("0 0 0.4", "3.14159265358979 0 0"):
            body = PLANE + slab(f"<mesh><uri>{name}.stl</uri></mesh>", turn=turn)
            heights[name, turn[0]] = load_world(world_file(tmp_path, body)).ground
    assert heights == pytest.approx({("floor", "0"): 0.05, ("floor", "3"): 0.05, ("walls", "0"): 0, ("walls", "3"): 0})
