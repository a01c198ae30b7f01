"""World files: shipped ones suit the robot, poses compose, broken ones are refused with file and line."""

import itertools
import math
import re
from collections import deque
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, rotation_matrix
from aro_robocop_goto_as.world.load import find_world, load_world
from aro_robocop_goto_as.world.model import Box, Cylinder, Plane, Sphere

WORLDS = Path(__file__).resolve().parents[2] / "worlds"
SHIPPED = {  # name: (boxes, cylinders, spawn), each with a ground plane besides
    "empty": (0, 0, Pose2D()),
    "stage_1": (4, 0, Pose2D()),
    "stage_2": (4, 4, Pose2D()),
    "stage_3": (4, 4, Pose2D()),
    "stage_4": (8, 2, Pose2D(-0.7, 0.0)),
    "world": (6, 9, Pose2D(-2.0, -0.5)),
    "maze_1": (18, 0, Pose2D()),
    "bench": (8, 5, Pose2D(1.0, 0.0)),
}
BURGER_RADIUS = 0.105  # [m]
CELL = 0.05  # [m] side of a raster cell
HALF = 160  # raster cells from the origin to each border: 8 m, outside of every wall


def shipped(name):
    return load_world(find_world(name, str(WORLDS)))


def clearance(world, points):
    """Distance [m] from each of the points (..., 2) [m] in the world frame to the nearest upright obstacle."""
    nearest = np.full(points.shape[:-1], np.inf)
    for obstacle in world.obstacles:
        if isinstance(obstacle.geometry, Plane):
            continue
        rotation = rotation_matrix(obstacle.pose.orientation)
        assert rotation[2, 2] == pytest.approx(1.0), f"{obstacle.name} is tilted"
        local = np.abs((points - obstacle.pose.position[:2]) @ rotation[:2, :2])
        if isinstance(obstacle.geometry, Box):
            outside = np.maximum(local - np.array(obstacle.geometry.size[:2]) / 2.0, 0.0)
            distance = np.linalg.norm(outside, axis=-1)
        else:
            distance = np.linalg.norm(local, axis=-1) - obstacle.geometry.radius
        nearest = np.minimum(nearest, distance)
    return nearest


def cell_of(x, y):
    return round(x / CELL) + HALF, round(y / CELL) + HALF


def flood(free, start):
    """Which raster cells can be reached from the start over free cells, by steps along x and y."""
    reached = np.zeros_like(free)
    reached[start] = free[start]
    queue = deque([start] if free[start] else [])
    while queue:
        i, j = queue.popleft()
        for step in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if all(0 <= k < n for k, n in zip(step, free.shape)) and free[step] and not reached[step]:
                reached[step] = True
                queue.append(step)
    return reached


def free_cells(world):
    axis = np.arange(-HALF, HALF + 1) * CELL
    return clearance(world, np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1)) > BURGER_RADIUS


RELATIVE = "<pose relative_to='{}'>1 0 0 0 0 0</pose>"


def write(directory, body, version="1.7"):
    """A world file with the body from line 3 on."""
    path = directory / "w.sdf"
    path.write_text(f'<sdf version="{version}">\n<world name="w">\n{body}\n</world>\n</sdf>\n', encoding="utf-8")
    return str(path)


def model(content, name="m", pose=""):
    return f'<model name="{name}"><static>true</static>{pose}<link name="l">\n{content}\n</link></model>'


def collision(geometry, name="c", pose=""):
    return f'<collision name="{name}">{pose}<geometry>{geometry}</geometry></collision>'


SPHERE = "<sphere><radius>0.5</radius></sphere>"


# The shipped worlds


def test_every_shipped_world_is_tested():
    assert {path.stem for path in WORLDS.glob("*.sdf")} == set(SHIPPED)


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_world_has_the_expected_obstacles_and_spawn(name):
    world = shipped(name)
    kinds = [type(obstacle.geometry) for obstacle in world.obstacles]
    boxes, cylinders, spawn = SHIPPED[name]
    assert (kinds.count(Box), kinds.count(Cylinder), kinds.count(Plane)) == (boxes, cylinders, 1)
    assert len(kinds) == boxes + cylinders + 1
    assert (world.name, world.spawn, world.path) == (name, spawn, str(WORLDS / f"{name}.sdf"))
    assert len({obstacle.name for obstacle in world.obstacles}) == len(world.obstacles)


@pytest.mark.parametrize("name", SHIPPED)
def test_obstacles_of_a_shipped_world_stand_on_its_ground(name):
    for obstacle in shipped(name).obstacles:
        if isinstance(obstacle.geometry, Plane):
            assert obstacle.pose.position == (0.0, 0.0, 0.0)
        else:
            height = obstacle.geometry.size[2] if isinstance(obstacle.geometry, Box) else obstacle.geometry.length
            assert (height, obstacle.pose.position[2]) == (0.5, 0.25)


@pytest.mark.parametrize("name", SHIPPED)
def test_robot_spawns_with_free_space_around_it(name):
    world = shipped(name)
    required = 0.6 if name == "stage_4" else 0.3
    assert clearance(world, np.array([world.spawn.x, world.spawn.y])) >= required


def test_robot_in_stage_4_can_drive_one_metre_straight_ahead():
    path = np.array([[-0.7 + x, 0.0] for x in np.linspace(0.0, 1.0, 101)])
    assert clearance(shipped("stage_4"), path).min() > 3.0 * BURGER_RADIUS


@pytest.mark.parametrize("name", [name for name in SHIPPED if name != "empty"])
def test_free_space_within_the_walls_is_connected_and_enclosed(name):
    world = shipped(name)
    free = free_cells(world)
    inside = flood(free, cell_of(world.spawn.x, world.spawn.y))
    outside = flood(free, (0, 0))
    assert inside.any() and not (inside & outside).any(), "the outer wall has a gap"
    assert (inside | outside)[free].all(), "a place within the walls is unreachable"


@pytest.mark.parametrize("name", SHIPPED)
def test_documented_goals_of_a_world_are_reachable(name):
    world = shipped(name)
    goals = re.findall(r"\(([^,()]+), ([^()]+)\)", Path(world.path).read_text(encoding="utf-8").split("Free goals:")[1])
    inside = flood(free_cells(world), cell_of(world.spawn.x, world.spawn.y))
    assert len(goals) >= 4
    assert [goal for goal in goals if not inside[cell_of(*map(float, goal))]] == []


def test_every_cell_of_the_maze_is_reachable():
    world = shipped("maze_1")
    inside = flood(free_cells(world), cell_of(world.spawn.x, world.spawn.y))
    assert all(inside[cell_of(column, row)] for column, row in itertools.product(range(6), range(6)))


# What is read


coordinate = st.floats(-10.0, 10.0)
angle = st.floats(-7.0, 7.0)
six_numbers = st.tuples(coordinate, coordinate, coordinate, angle, angle, angle)


def matrix(x, y, z, roll, pitch, yaw):
    """The (4, 4) transform of SDF's six numbers: rotations about the fixed x, y, z in that order, then a shift."""
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    transform = np.eye(4)
    transform[:3, :3] = about_z @ about_y @ about_x
    transform[:3, 3] = x, y, z
    return transform


@given(six_numbers, six_numbers, six_numbers)
def test_poses_of_model_link_and_collision_compose(tmp_path_factory, in_world, in_model, in_link):
    tags = [f"<pose>{' '.join(map(repr, pose))}</pose>" for pose in (in_world, in_model, in_link)]
    body = model(tags[1] + collision(SPHERE, pose=tags[2]), pose=tags[0])
    (obstacle,) = load_world(write(tmp_path_factory.getbasetemp(), body)).obstacles
    expected = matrix(*in_world) @ matrix(*in_model) @ matrix(*in_link)
    np.testing.assert_allclose(obstacle.pose.position, expected[:3, 3], atol=1e-9)
    np.testing.assert_allclose(rotation_matrix(obstacle.pose.orientation), expected[:3, :3], atol=1e-9)


def test_each_geometry_is_read_with_its_dimensions(tmp_path):
    shapes = {
        "box": ("<box><size>1 2e-1 +.3</size></box>", Box((1.0, 0.2, 0.3))),
        "cylinder": ("<cylinder><length>2.</length><radius>0.5</radius></cylinder>", Cylinder(0.5, 2.0)),
        "sphere": (SPHERE, Sphere(0.5)),
        "plane": ("<plane><normal>0 3 4</normal><size>1 1</size></plane>", Plane((0.0, 0.6, 0.8))),
        "level": ("<plane/>", Plane((0.0, 0.0, 1.0))),
    }
    body = model("".join(collision(xml, name) for name, (xml, _) in shapes.items()))
    obstacles = load_world(write(tmp_path, body)).obstacles
    assert [(o.name, o.geometry) for o in obstacles] == [(f"m/l/{name}", shape) for name, (_, shape) in shapes.items()]


@pytest.mark.parametrize("version", ["1.4", "1.5", "1.6", "1.7"])
def test_gazebos_ground_plane_and_sun_can_be_included(tmp_path, version):
    includes = "<include><uri>model://sun</uri></include>\n<include><uri> model://ground_plane </uri></include>"
    world = load_world(write(tmp_path, includes, version))
    (ground,) = world.obstacles
    assert (ground.name, ground.geometry) == ("ground_plane/link/collision", Plane((0.0, 0.0, 1.0)))
    assert ground.pose.position == (0.0, 0.0, 0.0)
    assert world.ignored == ("include 'sun' (line 3)",)


def test_spawn_is_the_pose_of_the_frame_robot_spawn(tmp_path):
    frames = '<frame name="other"/><frame name="robot_spawn"><pose>1 -2 0 0 0 4</pose></frame>'
    spawn = load_world(write(tmp_path, frames)).spawn
    assert (spawn.x, spawn.y, spawn.yaw) == (1.0, -2.0, pytest.approx(4.0 - 2.0 * math.pi))


def test_spawn_defaults_to_the_origin(tmp_path):
    assert load_world(write(tmp_path, "")).spawn == Pose2D(0.0, 0.0, 0.0)


def test_ignored_elements_are_listed_once_with_those_of_the_world_first(tmp_path):
    mover = '<model name="m"><static>1</static>\n<plugin name="mover"/><plugin name="mover"/></model>'
    silent = '<gravity>0 0 -9.8</gravity><gui><plugin name="p"/></gui>'
    world = load_world(write(tmp_path, f'<light name="lamp"/>\n{mover}\n{silent}\n<sensor name="eye"/>'))
    assert world.ignored == ("light 'lamp' (line 3)", "sensor 'eye' (line 7)", "plugin 'mover' (line 5)")


def test_frames_of_links_are_told_but_not_those_that_poses_can_be_relative_to(tmp_path):
    in_model = '<frame name="handle"/>\n<link name="l"><frame name="tip"/></link>'
    in_world = '<frame name="robot_spawn"/><frame name="door"/>'
    world = load_world(write(tmp_path, f'{in_world}\n<model name="m"><static>1</static>{in_model}</model>'))
    assert world.ignored == ("frame 'tip' (line 5)",)


def test_visuals_comments_foreign_elements_and_empty_frames_are_accepted(tmp_path):
    visual = '<visual name="v"><geometry><mesh><uri>model://a.dae</uri></mesh></geometry></visual>'
    shape = f'<x:colour xmlns:x="urn:x"/>{SPHERE}'
    pose = "<pose frame=''>1 2 <!-- three --> 3 0 0 -0</pose>"
    (obstacle,) = load_world(write(tmp_path, model(visual + collision(shape), pose=pose))).obstacles
    assert (obstacle.pose.position, obstacle.geometry) == ((1.0, 2.0, 3.0), Sphere(0.5))


@pytest.mark.parametrize("attribute", ["relative_to", "frame"])
def test_pose_may_name_its_default_frame(tmp_path, attribute):
    world, own, empty = (f"<pose {attribute}='{name}'>1 0 0 0 0 0</pose>" for name in ("world", "__model__", ""))
    spawn = f'<frame name="robot_spawn">{world}</frame>'
    include = f"<include><uri>model://ground_plane</uri>{world}</include>"
    link = f'<link name="l">{own}{collision(SPHERE, pose=empty)}</link>'
    body = f'<model name="m">{world}<model name="in">{own}{link}</model></model>'
    world_read = load_world(write(tmp_path, spawn + include + body))
    assert world_read.spawn == Pose2D(1.0, 0.0, 0.0)
    assert {o.name: o.pose.position for o in world_read.obstacles} == {
        "ground_plane/link/collision": (1, 0, 0),
        "m/in/l/c": (4, 0, 0),
    }


def test_pose_relative_to_the_world_counts_from_the_world_at_any_depth(tmp_path):
    in_world = "<pose relative_to='world'>1 2 3 0 0 0</pose>"
    moved = "<pose>10 20 30 0 0 1</pose>"
    link = f'<link name="l">{in_world}{collision(SPHERE)}</link>'
    inner = f'<model name="in">{in_world}<link name="l">{collision(SPHERE)}</link></model>'
    include = f"<include><uri>model://ground_plane</uri>{in_world}</include>"
    found = load_world(
        write(tmp_path, f'<model name="m"><static>1</static>{moved}{link}{inner}{include}</model>', "1.8")
    )
    assert [o.pose for o in found.obstacles] == [Pose3D((1.0, 2.0, 3.0))] * 3


def test_poses_relative_to_what_is_beside_compose(tmp_path):
    quarter = "0 0 1.5707963267948966"
    frame = f'<frame name="f"><pose>1 0 0 {quarter}</pose></frame><frame name="g" attached_to="f"/>'
    link = f'<link name="a"><pose relative_to="b">1 0 0 0 0 0</pose>{collision(SPHERE)}</link>'
    other = f'<link name="b"><pose>0 0 0 {quarter}</pose>{collision(SPHERE, pose=RELATIVE.format("a"))}</link>'
    own = f'<link name="c"><pose>5 5 5 1 1 1</pose>{collision(SPHERE, pose=RELATIVE.format("__model__"))}</link>'
    links = model("", pose="").replace('<link name="l">\n\n</link>', link + other + own)
    body = frame + model(collision(SPHERE), "n", '<pose relative_to="g">2 0 0 0 0 0</pose>') + links
    found = {o.name: o.pose for o in load_world(write(tmp_path, body, "1.8")).obstacles}
    expected = {"n/l/c": (1, 2, 0), "m/a/c": (0, 1, 0), "m/b/c": (0, 2, 0), "m/c/c": (1, 0, 0)}
    assert set(found) == set(expected)
    for name, position in expected.items():
        np.testing.assert_allclose(found[name].position, position, atol=1e-12)
    np.testing.assert_allclose(rotation_matrix(found["m/c/c"].orientation), np.eye(3), atol=1e-12)


def test_poses_relative_to_joints_compose_as_in_a_urdf_that_gz_converted(tmp_path):
    # `gz sdf -p ROBOT.urdf` places each joint in its parent link, and the child link at the joint, by an empty <pose>.
    quarter = "0 0 1.5707963267948966"
    joints = (
        f'<joint name="j" type="fixed"><pose relative_to="a">1 0 0 {quarter}</pose><child>b</child></joint>'
        '<joint name="k" type="fixed"><pose>0 0 3 0 0 0</pose><child>b</child></joint>'
    )
    links = "".join(
        f'<link name="{name}"><pose relative_to="{to}"{pose}{collision(SPHERE)}</link>'
        for name, to, pose in (("b", "j", "/>"), ("c", "b", " degrees='false'>2 0 0 0 0 0</pose>"), ("d", "k", "/>"))
    )
    body = f'<model name="m"><static>1</static><link name="a"><pose>0 1 0 0 0 0</pose></link>{joints}{links}</model>'
    found = {o.name: o.pose for o in load_world(write(tmp_path, body, "1.8")).obstacles}
    for name, position in {"m/b/c": (1, 1, 0), "m/c/c": (1, 3, 0), "m/d/c": (1, 1, 3)}.items():
        np.testing.assert_allclose(found[name].position, position, atol=1e-12)


def test_collision_may_be_placed_in_the_world(tmp_path):
    in_world = collision(SPHERE, pose="<pose relative_to='world'>1 2 3 0 0 0</pose>")
    (obstacle,) = load_world(write(tmp_path, model(in_world, pose="<pose>5 5 5 1 1 1</pose>"), "1.8")).obstacles
    assert obstacle.pose == Pose3D((1.0, 2.0, 3.0))


def test_last_of_several_static_counts(tmp_path):
    body = model(collision(SPHERE)).replace("</static>", "</static><static>0</static>")
    assert "motion of model 'm'" in load_world(write(tmp_path, body)).ignored[0]
    body = model(collision(SPHERE)).replace("<static>", "<static>0</static><static>")
    assert load_world(write(tmp_path, body)).ignored == ()


def test_saved_pose_may_name_the_world_at_any_depth(tmp_path):
    pose = "<pose relative_to='world'>5 0 0 0 0 0</pose>"
    state = f'<state><model name="m">{pose}<link name="l">{pose.replace("5", "7")}</link></model></state>'
    (obstacle,) = load_world(write(tmp_path, model(collision(SPHERE)) + state)).obstacles
    assert obstacle.pose.position == (7, 0, 0)


# What is refused


def raised_by(path):
    with pytest.raises(WorldError) as caught:
        load_world(str(path))
    return str(caught.value)


BROKEN = {  # case: (body from line 3 on, line of the error, what the message must name)
    "static neither true nor false": ('<model name="m"><static>yes</static></model>', 3, ["yes", "true or false"]),
    "second static neither true nor false": (
        '<model name="m"><static>1</static>\n<static>no</static></model>',
        4,
        ["no", "true or false"],
    ),
    "model without a name": ("<model><static>true</static></model>", 3, ["<model> has no name"]),
    "model named twice": (f'{model("", "a")}\n<model name="a"><static>true</static></model>', 6, ["'a'", "taken"]),
    "include named as a model": (
        model("", "ground_plane") + "\n\n<include><uri>model://ground_plane</uri></include>",
        7,
        ["'ground_plane'", "taken"],
    ),
    "collision named twice": (model(collision(SPHERE) + "\n" + collision(SPHERE)), 5, ["m/l/c", "'c'", "taken"]),
    "nested model named twice": (
        '<model name="m"><model name="in"/>\n<model name="in"/></model>',
        4,
        ["m/in", "'in'", "taken"],
    ),
    "misspelt element": (model('<colision name="wall"/>'), 4, ["<colision>", "wall", "collision"]),
    "state that adds a model": (
        '<state world_name="w">\n<insertions><model/></insertions></state>',
        4,
        ["<insertions>", "<model>"],
    ),
    "state that scales": (
        '<state><model name="m"><pose>0 0 0 0 0 0</pose>\n<scale>1 2 1</scale></model></state>',
        4,
        ["1 2 1", "'m'"],
    ),
    "include of nothing known": (
        "\n<include><uri>model://cafe</uri></include>",
        4,
        ["model://cafe", "beside the file", ".gazebo/models"],
    ),
    "include from the web": ("<include><uri>https://fuel.org/cafe</uri></include>", 3, ["https://fuel", "model://"]),
    "include without uri": ("<include><name>i</name></include>", 3, ["<uri>"]),
    "mesh that isn't there": (
        model(collision("<mesh>\n<uri>model://a/b.dae</uri></mesh>")),
        5,
        ["model://a/b.dae", "m/l/c", "not found"],
    ),
    "mesh without uri": (model(collision("<mesh/>")), 4, ["<mesh>", "<uri>", "m/l/c"]),
    "part of a mesh": (model(collision("<mesh><uri>a</uri><submesh/></mesh>")), 4, ["<submesh>", "m/l/c", "scale"]),
    "heightmap": (model(collision("<heightmap/>")), 4, ["<heightmap>", "m/l/c", "box"]),
    "two shapes": (model(collision(SPHERE + "<plane/>")), 4, ["2 shapes"]),
    "no shape": (model(collision("")), 4, ["0 shapes"]),
    "no geometry": (model('<collision name="c"/>'), 4, ["<geometry>"]),
    "pose relative to a frame": (
        model('<pose relative_to="door">0 0 0 0 0 0</pose>'),
        4,
        ["relative_to='door'", "m/l", "parent"],
    ),
    "poses relative to each other": (
        "\n".join(
            f'<model name="{a}"><static>1</static><pose relative_to="{b}">1 0 0 0 0 0</pose></model>'
            for a, b in ("ab", "ba")
        ),
        3,
        ["'a'", "relative to itself"],
    ),
    "pose relative to an include that says no pose": (
        "<include><name>i</name><uri>model://ground_plane</uri></include>\n"
        + model("", pose="<pose relative_to='i'>0 0 0 0 0 0</pose>"),
        4,
        ["'i'", "without <pose>"],
    ),
    "frame attached to nothing known": (
        '<frame name="f" attached_to="a::b"/>\n' + model("", pose="<pose relative_to='f'>0 0 0 0 0 0</pose>"),
        3,
        ["attached_to='a::b'"],
    ),
    "model placed by a frame of its own": ('<model name="m" placement_frame="l"/>', 3, ["placement_frame", "'m'"]),
    "include that is merged": ("<include merge='1'><uri>model://sun</uri></include>", 3, ["merge"]),
    "model from Gazebo Fuel": (
        "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun</uri></include>",
        3,
        ["models/Sun'", "Gazebo Fuel", "nothing is downloaded"],
    ),
    "web page of a model on Gazebo Fuel": (
        "<include><uri>HTTPS://app.gazebosim.org/OpenRobotics/fuel/models/Sun</uri></include>",
        3,
        ["models/Sun'", "Gazebo Fuel", "nothing is downloaded"],
    ),
    "model whose name only sounds like Gazebo Fuel": (
        "<include><uri>model://fuel.can</uri></include>",
        3,
        ["model://fuel.can", "not found"],
    ),
    "pose relative to a joint of an unknown link": (
        '<model name="m"><joint name="j"><child>b</child></joint><link name="l"><pose relative_to="j"/></link></model>',
        3,
        ["<child>b</child>", "<joint>", "beside it"],
    ),
    "too long a chain of frames": (
        "".join(f'<frame name="f{i}" attached_to="f{i + 1}"/>' for i in range(3000))
        + '<frame name="f3000"/><model name="m"><pose relative_to="f0"/></model>',
        3,
        ["more than 100 poses"],
    ),
    "saved state that deletes a model": (
        '<state world_name="w">\n<deletions>m</deletions></state>',
        4,
        ["<deletions>"],
    ),
    "link at its own joint": (
        '<model name="m"><joint name="j"><child>l</child></joint><link name="l"><pose relative_to="j"/></link></model>',
        3,
        ["m/l", "relative to itself"],
    ),
    "pose in a frame of SDF 1.4": (model('\n<pose frame="hall">0 0 0 0 0 0</pose>'), 5, ["frame='hall'"]),
    "pose of a link in the world of SDF 1.4": (
        model("\n<pose frame='world'>0 0 0 0 0 0</pose>"),
        5,
        ["frame='world'", "m/l"],
    ),
    "pose of a model in itself": (
        model("", pose="<pose frame='__model__'>0 0 0 0 0 0</pose>"),
        3,
        ["frame='__model__'", "'m'", "parent"],
    ),
    "pose in degrees": (model('<pose degrees="true">0 0 0 0 0 90</pose>'), 4, ["degrees='true'"]),
    "pose of five numbers": (model("<pose>0 0 0\n0 0</pose>"), 4, ["<pose>", "'0 0 0 0 0'", "6 finite numbers"]),
    "pose that isn't a number": (model("<pose>nan 0 0 0 0 0</pose>"), 4, ["'nan 0 0 0 0 0'"]),
    "number beyond all bounds": (model("<pose>1e999 0 0 0 0 0</pose>"), 4, ["1e999", "finite"]),
    "number in Python's spelling": (model("<pose>1_0 0 0 0 0 0</pose>"), 4, ["1_0"]),
    "element among numbers": (model("<pose>0 0 0 <x/> 0 0 0</pose>"), 4, ["<x>", "<pose>"]),
    "negative radius": (
        model(collision("<sphere>\n<radius>-1</radius></sphere>")),
        5,
        ["m/l/c", "<radius>", "'-1'", "greater than 0"],
    ),
    "box without height": (model(collision("<box><size>1 1 0</size></box>")), 4, ["<size>", "'1 1 0'"]),
    "box without size": (model(collision("<box/>")), 4, ["<box>", "<size>"]),
    "cylinder without length": (model(collision("<cylinder><radius>1</radius></cylinder>")), 4, ["<length>"]),
    "plane that faces nowhere": (model(collision("<plane><normal>0 0 0</normal></plane>")), 4, ["<normal>"]),
    "spawn in the air": ('<frame name="robot_spawn"><pose>0 0 1 0 0 0</pose></frame>', 3, ["robot_spawn", "0 0 0 yaw"]),
    "spawn on a model": ('<frame name="robot_spawn" attached_to="m"/>', 3, ["robot_spawn", "attached"]),
    "two spawns": ('<frame name="robot_spawn"/>\n<frame name="robot_spawn"/>', 4, ["robot_spawn", "taken"]),
    "not XML": ("\n<model></modle>", 4, ["modle", "XML"]),
}


@pytest.mark.parametrize(("body", "line", "named"), BROKEN.values(), ids=BROKEN.keys())
def test_broken_world_is_refused_with_file_line_and_name(tmp_path, body, line, named):
    path = write(tmp_path, body)
    message = raised_by(path)
    assert message.startswith(f"{path}:{line}: ")
    assert [name for name in named if name not in message] == []


BROKEN_FRAMES = {  # case: (the whole file, line of the error, what the message must name)
    "not SDF": ("<gazebo version='1.0'/>", 1, ["<gazebo>", "<sdf>"]),
    "unsupported version": ("\n<sdf version='1.9'><world name='w'/></sdf>", 2, ["'1.9'", "1.4, 1.5, 1.6, 1.7"]),
    "no version": ("<sdf><world name='w'/></sdf>", 1, ["version None"]),
    "no world": ("<sdf version='1.7'/>", 1, ["<world>"]),
    "two worlds": ("<sdf version='1.7'><world name='a'/>\n<world name='b'/></sdf>", 2, ["second <world>"]),
    "light outside of a world": ("<sdf version='1.7'>\n<light name='stray'/></sdf>", 2, ["<light>", "stray"]),
    "world without a name": ("<sdf version='1.7'>\n<world/></sdf>", 2, ["<world> has no name"]),
    "empty file": ("", 1, ["XML"]),
    "undeclared entity": ("<sdf version='1.7'>\n<world name='w'>&x;</world></sdf>", 2, ["'x'", "XML"]),
}


@pytest.mark.parametrize(("text", "line", "named"), BROKEN_FRAMES.values(), ids=BROKEN_FRAMES.keys())
def test_file_that_is_not_a_world_is_refused_with_file_line_and_name(tmp_path, text, line, named):
    path = tmp_path / "w.sdf"
    path.write_text(text, encoding="utf-8")
    message = raised_by(path)
    assert message.startswith(f"{path}:{line}: ")
    assert [name for name in named if name not in message] == []


@pytest.mark.parametrize(
    "dtd",
    ["", '[<!ENTITY e SYSTEM "file:///etc/hostname">]', '[<!ENTITY e "aa">]', 'SYSTEM "http://localhost/sdf.dtd"'],
)
def test_doctype_is_refused_whatever_it_declares(tmp_path, dtd):
    path = tmp_path / "w.sdf"
    text = "&e;" if "ENTITY" in dtd else ""
    path.write_text(f"<!DOCTYPE sdf {dtd}>\n<sdf version='1.7'><world name='w'>{text}</world></sdf>", "utf-8")
    message = raised_by(path)
    assert message.startswith(f"{path}: ") and "DOCTYPE" in message


def test_exponentially_expanding_entities_are_refused(tmp_path):
    path = tmp_path / "w.sdf"
    levels = "".join(f"<!ENTITY e{n + 1} '{f'&e{n};' * 10}'>" for n in range(20))
    path.write_text(f"<!DOCTYPE sdf [<!ENTITY e0 'a'>{levels}]>\n<sdf version='&e20;'/>", "utf-8")
    assert raised_by(path).startswith(f"{path}:")


def test_unreadable_file_is_refused_by_name(tmp_path):
    assert "nowhere.sdf" in raised_by(tmp_path / "nowhere.sdf")
    assert str(tmp_path) in raised_by(tmp_path)


@pytest.mark.parametrize("name", ["bludiště č. 1.sdf", "50%25.sdf", "100 %.sdf", "a#b?c:d.sdf"])
def test_special_characters_in_file_names_are_shown_unchanged(tmp_path, name):
    path = tmp_path / name
    path.write_text("<sdf/>", encoding="utf-8")
    assert raised_by(path).startswith(f"{path}:1: ")


@given(st.one_of(st.binary(max_size=60), st.text(max_size=60).map(lambda text: text.encode("utf-8", "replace"))))
def test_arbitrary_content_raises_only_world_errors(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "any.sdf"
    path.write_bytes(content)
    raised_by(path)


@given(st.text(alphabet="0123456789 .eE+-_xinfa\n", max_size=30))
def test_arbitrary_pose_text_raises_only_world_errors(tmp_path_factory, pose):
    path = write(tmp_path_factory.getbasetemp(), model(f"<pose>{pose}</pose>" + collision(SPHERE)))
    try:
        (obstacle,) = load_world(path).obstacles
    except WorldError:
        return
    assert np.isfinite(obstacle.pose.position).all() and np.isfinite(obstacle.pose.orientation).all()


# Where worlds are found


def test_bare_name_is_looked_up_in_the_worlds_directory():
    assert find_world("stage_4", str(WORLDS)) == str(WORLDS / "stage_4.sdf")


def test_file_name_with_an_extension_is_a_path(tmp_path, monkeypatch):
    (tmp_path / "mine.world").touch()
    assert find_world(str(tmp_path / "mine.world"), str(WORLDS)) == str(tmp_path / "mine.world")
    monkeypatch.chdir(tmp_path)
    assert find_world("mine.world", str(WORLDS)) == "mine.world"


@pytest.mark.parametrize("name", ["hause", "./stage_4", "stage_4.sdf", ""])
def test_unknown_world_is_refused_with_the_known_names(name):
    with pytest.raises(WorldError) as caught:
        find_world(name, str(WORLDS))
    assert f"'{name}'" in str(caught.value)
    assert "empty, maze_1, stage_1, stage_2, stage_3, stage_4, world" in str(caught.value)


def test_missing_worlds_directory_is_reported_as_having_none(tmp_path):
    with pytest.raises(WorldError, match="none"):
        find_world("stage_4", str(tmp_path / "missing"))
