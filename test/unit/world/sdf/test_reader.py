"""Worlds and models: what is read, what is listed as ignored, and what is refused with file and line."""

import math

import pytest
from sdf_files import BOX, SPHERE, collision, model, raised_by, sdf_file, world_file

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.shapes import Box, Cylinder, Plane, Sphere
from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.sdf import reader

MOVER = '<plugin name="p" filename="robocop_motion">{}</plugin>'
POST = "<cylinder><radius>0.1</radius><length>1</length></cylinder>"
BEFORE_THE_WORLD = (
    "<gravity>0 0 -9.8</gravity><physics/><light name='sun'/><gui><plugin name='p'/></gui><wind/><scene/>"
)


def nested(count):
    """Models within each other."""
    return "".join(f"<model name='m{i}'><static>1</static>" for i in range(count)) + "</model>" * count


READ = {  # case: (body from line 3 on, {obstacle: its position [m]}, what is said of the rest)
    "what Gazebo writes into every world": (BEFORE_THE_WORLD, {}, ()),
    "models of Gazebo that need no file": (
        "<include><uri>model://ground_plane</uri></include><include><uri>model://sun/model.sdf</uri></include>",
        {"ground_plane/link/collision": (0, 0, 0)},
        (),
    ),
    "plugins of Gazebo Sim itself": ("<plugin filename='gz-sim-physics-system' name='Physics'/>", {}, ()),
    "an actor": ("<actor name='walker'><skin/></actor>", {}, ()),
    "an extension in another namespace": ("<x:note xmlns:x='urn:x'>mine</x:note>", {}, ()),
    "comments that XML forbids and Gazebo reads": (
        "<!-- ---- walls ---- -->\n<!------- old --->\n<model name='m'><static>1</static><lin/></model>",
        {},
        ("<lin> in <model> is left out (line 5)",),
    ),
    "models within models": (
        "<model name='house'><static>1</static><pose>1 0 0 0 0 0</pose>"
        f"<model name='room'><pose>1 0 0 0 0 0</pose>{BOX}</model></model>",
        {"house/room/l/c": (2, 0, 0)},
        (),
    ),
    "angles in degrees, and a quaternion of any length": (
        model(
            "<pose rotation_format='quat_xyzw'>0 -1 0   0 0 -3 3</pose>"
            + collision(SPHERE, pose="<pose>1 0 0 0 0 0</pose>"),
            pose="<pose degrees='true'>2 0 0 0 0 90</pose>",
        ),
        {"m/l/c": (4, 0, 0)},
        (),
    ),
    "a collision of a link that is pitched": (
        model("<pose degrees='1'>0 0 0 0 90 0</pose>" + collision(SPHERE, pose="<pose>1 0 0 0 0 0</pose>")),
        {"m/l/c": (0, 0, -1)},
        (),
    ),
    "a pose relative to a link of another model": (
        model("<pose>2 1 0 0 0 0</pose>")
        + model(collision(SPHERE), "n", "<pose relative_to='m::l'>1 0 0 0 0 0</pose>"),
        {"n/l/c": (3, 1, 0)},
        (),
    ),
    "a merged include": (
        "<model name='m'><static>1</static><include merge='true'><uri>model://ground_plane</uri></include></model>",
        {"m/ground_plane/link/collision": (0, 0, 0)},
        (),
    ),
    "a placement frame": (
        '<model name="m" placement_frame="l"><static>1</static></model>',
        {},
        ("placement_frame of model 'm' is left out (line 3)",),
    ),
    "a height map and an unknown element": (
        model(collision("<heightmap/>") + '<colision name="wall"/>'),
        {},
        ("<colision> 'wall' in <link> is left out (line 4)", "'m/l/c' is left out: <heightmap> (line 4)"),
    ),
    "a part of a mesh": (
        model(collision("<mesh><uri>a</uri><submesh/></mesh>")),
        {},
        ("'m/l/c' is left out: <submesh> (line 4)",),
    ),
    "a mesh on the web": (
        model(collision("<mesh><uri>HTTPS://a.org/b.dae</uri></mesh>")),
        {},
        ("'m/l/c' is left out: 'HTTPS://a.org/b.dae' is a web address, and nothing is downloaded (line 4)",),
    ),
    "a model on Fuel": (
        "<include><uri>fuel://a/models/Desk</uri></include>",
        {},
        ("an include is left out: 'fuel://a/models/Desk' is a web address, and nothing is downloaded (line 3)",),
    ),
    "links and collisions of one name": (
        f'<model name="m"><static>1</static>{BOX}<link name="l">\n' + 2 * collision(SPHERE) + "</link></model>",
        {"m/l/c": (0, 0, 0), "m/l_1/c": (0, 0, 0), "m/l_1/c_1": (0, 0, 0)},
        (
            "the name 'l' is already taken, so this link is called 'l_1' (line 3)",
            "the name 'c' is already taken, so this collision is called 'c_1' (line 4)",
        ),
    ),
    "unknown elements of the world": (
        "<population name='cans'/><stat/>",
        {},
        ("<population> 'cans' in <world> is left out (line 3)", "<stat> in <world> is left out (line 3)"),
    ),
    "a state that moves models and links": (
        "".join(f"<model name='{name}'><static>1</static>{BOX}</model>" for name in "ab")
        + """<state world_name="w"><sim_time>1 2</sim_time><iterations>3</iterations><insertions/><deletions/>
        <model name="a"><static>1</static><pose frame="">1 2 3 0 0 0</pose><scale>1 1 1</scale><joint name="j"/></model>
        <model name="b"><pose>9 9 9 0 0 0</pose><link name="l"><pose>4 5 6 0 0 0</pose><wrench/></link>
        </model><model name="gone"><pose>0 0 0 0 0 0</pose></model><light name="sun"/></state>""",
        {"a/l/c": (1, 2, 3), "b/l/c": (4, 5, 6)},
        (),
    ),
    "a state that scales a model": (
        model(collision(SPHERE)) + "<state><model name='m'><scale>1 2  1</scale></model></state>",
        {"m/l/c": (0, 0, 0)},
        ("<scale> 1 2  1 in the state of 'm' is left out (line 5)",),
    ),
    "insertions and deletions of a state": (
        "<state><insertions><model/></insertions><deletions>m</deletions>\n<modle/></state>",
        {},
        (
            "<modle> in <state> is left out (line 4)",
            "<insertions> in <state> is left out (line 3)",
            "<deletions> in <state> is left out (line 3)",
        ),
    ),
}


@pytest.mark.parametrize(("body", "positions", "said"), READ.values(), ids=READ)
def test_what_can_be_simulated_is_read_and_the_rest_is_listed_with_its_line(tmp_path, body, positions, said):
    world = load_world(world_file(tmp_path, f'{body}<model name="last"><static>1</static>{BOX}</model>', "1.11"))
    found = {obstacle.name: obstacle.pose.position for obstacle in world.obstacles}
    assert list(found) == [*positions, "last/l/c"]
    assert [found[name] for name in positions] == [pytest.approx(position) for position in positions.values()]
    assert (world.ignored, world.approximated) == ((), said)


def test_each_geometry_is_read_with_its_dimensions(tmp_path):
    shapes = {
        "box": ("<box><size>1 2e-1 +.3</size></box>", Box((1.0, 0.2, 0.3))),
        "cylinder": ("<cylinder><length>2.</length><radius>0.5</radius></cylinder>", Cylinder(0.5, 2.0)),
        "sphere": (SPHERE, Sphere(0.5)),
        "plane": ("<plane><normal>0 3 4</normal><size>1 1</size></plane>", Plane((0.0, 0.6, 0.8))),
        "level": ("<plane/>", Plane((0.0, 0.0, 1.0))),
    }
    body = model("".join(collision(xml, name) for name, (xml, _) in shapes.items()))
    obstacles = load_world(world_file(tmp_path, body)).obstacles
    assert [(o.name, o.geometry) for o in obstacles] == [(f"m/l/{name}", shape) for name, (_, shape) in shapes.items()]


def test_oldest_version_may_have_empty_frames_and_the_last_of_several_static_counts(tmp_path):
    pose = "<pose frame=''>2 0 0 0 -0 0</pose>"
    body = f"<model name='m'><static>0</static><static>1</static>{pose}{BOX}</model>"
    world = load_world(world_file(tmp_path, body, "1.4"))
    assert ([obstacle.pose.position for obstacle in world.obstacles], world.ignored) == ([(2, 0, 0)], ())


def test_spawn_is_the_pose_of_the_frame_robot_spawn(tmp_path):
    frames = '<frame name="other"/><frame name="robot_spawn"><pose>1 -2 0 0 0 4</pose></frame>'
    world = load_world(world_file(tmp_path, frames))
    assert world.has_spawn and world.spawn == pytest.approx((1.0, -2.0, 4.0 - 2.0 * math.pi))


def test_plugins_are_listed_once_with_those_of_the_world_first(tmp_path):
    mover = '<model name="m"><static>1</static>\n<plugin name="mover"/><plugin name="mover"/></model>'
    world = load_world(world_file(tmp_path, f'{mover}\n<plugin name="eye"/>'))
    assert world.ignored == ("plugin 'eye' (line 5)", "plugin 'mover' (line 4)")


BROKEN = {  # case: (body from line 3 on, line of the error, what the message must name)
    "static neither true nor false": ('<model name="m"><static>yes</static></model>', 3, ["yes", "true or false"]),
    "model without a name": ("<model><static>true</static></model>", 3, ["<model> has no name"]),
    "include without uri": ("<include><name>i</name></include>", 3, ["<uri>"]),
    "mesh that isn't there": (
        model(collision("<mesh>\n<uri>file://a/b.dae</uri></mesh>")),
        5,
        ["file://a/b.dae", "m/l/c", "not found"],
    ),
    "no shape": (model(collision("")), 4, ["0 shapes"]),
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
    "too long a chain of frames": (
        "".join(f'<frame name="f{i}" attached_to="f{i + 1}"/>' for i in range(3000))
        + '<frame name="f3000"/><model name="m"><pose relative_to="f0"/></model>',
        3,
        ["more than 100 poses"],
    ),
    "pose in a frame of SDF 1.4": (model('\n<pose frame="hall">0 0 0 0 0 0</pose>'), 5, ["frame='hall'"]),
    "quaternion of zeros": (model('<pose rotation_format="quat_xyzw">1 0 0 0 0 0 0</pose>'), 4, ["not zero"]),
    "pose of five numbers": (model("<pose>0 0 0\n0 0</pose>"), 4, ["<pose>", "'0 0 0 0 0'", "6 finite numbers"]),
    "number out of range": (model("<pose>1e300 0 0 0 0 0</pose>"), 4, ["1e300", "within +-1e+06"]),
    "element among numbers": (model("<pose>0 0 0 <x/> 0 0 0</pose>"), 4, ["<x>", "<pose>"]),
    "negative radius": (
        model(collision("<sphere>\n<radius>-1</radius></sphere>")),
        5,
        ["m/l/c", "<radius>", "'-1'", "greater than 0"],
    ),
    "plane that faces nowhere": (model(collision("<plane><normal>0 0 0</normal></plane>")), 4, ["<normal>"]),
    "spawn in the air": (
        '<frame name="robot_spawn"><pose>0 0 1 0 0 0</pose></frame>',
        3,
        ["robot_spawn", "z up to 0.2"],
    ),
    "spawn on a model": ('<frame name="robot_spawn" attached_to="m"/>', 3, ["robot_spawn", "attached"]),
    "two spawns": ('<frame name="robot_spawn"/>\n<frame name="robot_spawn"/>', 4, ["robot_spawn", "second"]),
    "too many models within models": (nested(21), 3, ["more than 20 models within each other"]),
    "unknown part of a motion": (model("", pose=MOVER.format("<spin>1</spin>")), 3, ["<spin>", "turn, waypoint"]),
    "waypoints at one time": (
        model("", pose=MOVER.format("<waypoint>1 1 0</waypoint><waypoint>1 0 0</waypoint>")),
        3,
        ["at 1 s", "later"],
    ),
    "motion that does not return": (
        model("", pose=MOVER.format("<waypoint>1 1 0</waypoint>")),
        3,
        ["'1 0'", "0 0, where the cycle starts again"],
    ),
    "two motions": (model("", pose=2 * MOVER.format("<turn>1</turn>")), 3, ["second", "robocop_motion"]),
    "tilted shape that moves": (
        model(collision(POST, pose="<pose>0 0 0 1 0 0</pose>"), pose=MOVER.format("<turn>1</turn>")),
        4,
        ["m/l/c", "upright cylinders, spheres"],
    ),
}


@pytest.mark.parametrize(("body", "line", "named"), BROKEN.values(), ids=BROKEN.keys())
def test_broken_world_is_refused_with_file_line_and_name(tmp_path, body, line, named):
    path = world_file(tmp_path, body)
    message = raised_by(path)
    assert message.startswith(f"{path}:{line}: ")
    assert [name for name in named if name not in message] == []


def test_models_that_are_not_on_this_machine_are_left_out_and_listed_in_one_text(tmp_path):
    table = collision("<mesh><uri>model://table/meshes/table.dae</uri></mesh>", name="table")
    body = "<include><uri>model://mailbox</uri></include>\n" + model(table + collision(SPHERE)) + model(table, name="n")
    world = load_world(world_file(tmp_path, body))
    assert [obstacle.name for obstacle in world.obstacles] == ["m/l/c"]
    (said,) = world.approximated
    assert "mailbox (line 3), table (line 5);" in said and "https://github.com/osrf/gazebo_models" in said


def test_file_that_a_model_on_this_machine_lacks_is_refused_with_the_places_searched(tmp_path, chair):
    mesh = collision("<mesh><uri>model://chair/meshes/seat.dae</uri></mesh>")
    said = raised_by(world_file(tmp_path, model(mesh)))
    assert "'model://chair/meshes/seat.dae' was not found; looked for: " in said and "chair/meshes/seat.dae" in said


def test_include_overrides_the_models_pose_and_name(tmp_path, chair):
    seat = "<include><uri>model://chair</uri><name>{}</name><pose>{} 0 0 0 0 0</pose></include>"
    world = load_world(world_file(tmp_path / "worlds", seat.format("a", 1) + seat.format("b", 2)))
    assert [(o.name, o.pose.position) for o in world.obstacles] == [("a/l/c", (1, 0, 0)), ("b/l/c", (2, 0, 0))]
    assert {name: pose.position for name, pose in world.models.items()} == {"a": (1, 0, 0), "b": (2, 0, 0)}


def test_models_that_include_each_other_are_refused_with_the_chain_of_includes(tmp_path, chair):
    desk = tmp_path / "models" / "desk"
    sdf_file(chair / "new.sdf", '<model name="chair"><include><uri>model://desk</uri></include></model>')
    sdf_file(desk / "model.sdf", '<model name="desk">\n\n<include><uri>model://chair</uri></include></model>')
    world = world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>")
    message = raised_by(world)
    assert message.startswith(f"{desk}/model.sdf:4: in 'desk': 'model://chair' is {chair}/new.sdf again, within")
    assert message.endswith(f"; included by {chair}/new.sdf:2; included by {world}:3")


def test_world_of_too_many_models_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(reader, "MAX_MODELS", 2)
    assert "more than 2 models; supported: 2" in raised_by(world_file(tmp_path, "".join(model("", n) for n in "abc")))


def test_models_of_the_same_name_are_numbered(tmp_path, chair):
    seat = "<include><uri>model://chair</uri><pose>{} 0 0 0 0 0</pose></include>\n"
    room = f'<model name="room"><static>1</static>{seat.format(7)}{seat.format(8)}</model>'
    body = seat.format(1) + seat.format(2) + '<model name="chair"><static>1</static>' + BOX + "</model>\n" + room
    world = load_world(world_file(tmp_path / "worlds", body))
    assert [o.name for o in world.obstacles] == ["chair/l/c", "chair_1/l/c", "chair_2/l/c", "room/chair/l/c"] + [
        "room/chair_1/l/c"
    ]
    assert list(world.models) == ["chair", "chair_1", "chair_2", "room"]
    assert world.approximated == (
        "the name 'chair' is already taken, so this model is called 'chair_1' (line 4)",
        "the name 'chair' is already taken, so this model is called 'chair_2' (line 5)",
        "the name 'chair' is already taken, so this model is called 'chair_1' (line 7)",
    )


def test_model_file_can_be_loaded_as_a_world(chair):
    world = load_world(str(chair / "new.sdf"))
    assert (world.name, [o.name for o in world.obstacles], world.spawn) == ("chair", ["chair/l/c"], Pose2D())


def test_non_static_model_is_treated_as_static_and_listed_once(tmp_path):
    others = '<model name="wall"><static>1</static></model><model name="ball"/>'
    body = f'<model name="cart">\n{BOX}<model name="load"/></model>{others}'
    world = load_world(world_file(tmp_path, body))
    assert [o.name for o in world.obstacles] == ["cart/l/c"]
    assert world.ignored == ("motion of models that are not static, such as 'cart' (line 3)",)


def test_ignored_elements_of_an_included_file_are_listed_with_that_file(tmp_path, chair):
    sdf_file(chair / "new.sdf", '<model name="chair"><static>1</static><plugin name="p"/></model>')
    world = load_world(world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>"))
    assert world.ignored == (f"plugin 'p' ({chair}/new.sdf:2)",)
