"""Robots that were saved with a world are left out; the simulator's own one starts at the first one's place."""

import pytest
from sdf_files import BOX, sdf_file, world_file
from support import model_named

from aro_robocop_goto_as.floor_plan.free_places import free_place
from aro_robocop_goto_as.world.load import load_world

START = ", and a robot starts at its pose if there is room"
DRIVEN = "<pose>{} 0 0 0 0 0</pose><plugin name='differential_drive_controller' filename='libx.so'/>"
SAVED = {  # case: (body from line 3 on, names of the obstacles, [x, y] where a Burger starts [m], what is said)
    "at another pose by the state, beside a room that is called like it": (
        f"<model name='turtlebot3_burger'>{BOX}</model><model name='turtlebot3_house'><static>1</static>{BOX}</model>"
        "<state><model name='turtlebot3_burger'><pose>1.5 0.5 0 0 0 0.3</pose></model></state>",
        ["turtlebot3_house/l/c"],
        (1.5, 0.5),
        [f"the robot 'turtlebot3_burger' is left out{START} (line 3)"],
    ),
    "within a room that is a model": (
        "<model name='house'><static>0</static><pose>1 1 0 0 0 0</pose>"
        f"<model name='robot'>{DRIVEN.format(0.5)}</model><include><uri>model://turtlebot3_waffle</uri></include></model>",
        [],
        (1.5, 1.0),
        [
            f"the robot 'house/robot' is left out{START} (line 3)",
            "the robot 'house/turtlebot3_waffle' is left out (line 3)",
        ],
    ),
    "by names of its links, while the world has a place for ours": (
        "<frame name='robot_spawn'><pose>-1 0 0 0 0 0</pose></frame><include><uri>model://cleaner</uri></include>",
        [],
        (-1.0, 0.0),
        ["the robot 'vacuum' is left out (line 3)"],
    ),
    "at a wall": (
        f"<model name='a'>{DRIVEN.format(2)}</model>"
        f"<model name='wall'><static>1</static><pose>2.6 0 0.5 0 0 0</pose>{BOX}</model>",
        ["wall/l/c"],
        (1.8, 0.0),
        [f"the robot 'a' is left out{START} (line 3)"],
    ),
    "no robot but a desk with a link of a robot's name": (
        f"<model name='desk'><static>0</static><pose>5 0 0 0 0 0</pose><link name='base_link'/>{BOX}</model>",
        ["desk/l/c"],
        (0.0, 0.0),
        [],
    ),
    "as a part of the scenery": (
        f"<model name='shop'><static>1</static><pose>5 5 0 0 0 0</pose><model name='burger'>{BOX}</model></model>",
        ["shop/burger/l/c"],
        (0.0, 0.0),
        [],
    ),
}


@pytest.mark.parametrize(("body", "names", "start", "said"), SAVED.values(), ids=SAVED)
def test_saved_robot_is_left_out_and_ours_starts_in_its_place(tmp_path, body, names, start, said):
    links = "".join(f"<link name='{name}'/>" for name in ("base_link", "left_wheel", "wheel_right_link"))
    sdf_file(tmp_path / "models" / "cleaner" / "model.sdf", f"<model name='vacuum'>{links}</model>")
    world = load_world(world_file(tmp_path, body))
    assert [obstacle.name for obstacle in world.obstacles] == names
    assert list(world.approximated) == said
    assert free_place(world, world.spawn, model_named("burger"))[:2] == pytest.approx(start, abs=1e-6)
