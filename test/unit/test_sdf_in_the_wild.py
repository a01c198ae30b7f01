"""World files as found in practice: included and nested models, saved states, meshes of every format."""

import numpy as np
import pytest
import trimesh
from bullet_rays import bullet_rays
from support import world_named

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose2D, Twist2D, rotation_matrix
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.physics.bullet import BulletEngine
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import Slice
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.world.load import load_world
from aro_robocop_goto_as.world.model import Mesh, Plane

BOX = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
# An upright triangle on the x axis; the unit is centimetres, and x is declared to be up, which Gazebo ignores.
TRIANGLE_DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimeter" meter="0.01"/><up_axis>X_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 0 200</float_array>
      <technique_common><accessor source="#a" count="3" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node><translate>0 300 0</translate>
    <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def sdf_file(path, body, version="1.6"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'<sdf version="{version}">\n{body}\n</sdf>\n', encoding="utf-8")
    return str(path)


def world_file(tmp_path, body, name="w.world"):
    return sdf_file(tmp_path / name, f'<world name="w">\n{body}\n</world>')


def mesh_world(tmp_path, uri, scale="", pose=""):
    geometry = f"<geometry><mesh><uri>{uri}</uri>{scale}</mesh></geometry>"
    collision = f'<link name="l"><collision name="c">{geometry}</collision></link>'
    return world_file(tmp_path, f'<model name="m"><static>1</static>{pose}{collision}</model>')


def only_obstacle(path):
    (obstacle,) = load_world(path).obstacles
    return obstacle


def raised_by(path):
    with pytest.raises(WorldError) as caught:
        load_world(path)
    return str(caught.value)


@pytest.fixture
def chair(tmp_path, monkeypatch):
    """A model directory in GAZEBO_MODEL_PATH with two versions of the model."""
    home = tmp_path / "models" / "chair"
    sdf_file(home / "old.sdf", '<model name="old"/>', "1.4")
    sdf_file(home / "new.sdf", f'<model name="chair"><pose>5 5 5 0 0 0</pose>{BOX}</model>')
    (home / "model.config").write_text(
        "<model><sdf version='1.6'>new.sdf</sdf><sdf version='1.4'>old.sdf</sdf><sdf version='1.9'>no.sdf</sdf></model>"
    )
    monkeypatch.setenv("GAZEBO_MODEL_PATH", f"{tmp_path / 'none'}:{tmp_path / 'models'}")
    return home


# Includes


def test_include_overrides_the_models_pose_and_name(tmp_path, chair):
    seat = "<include><uri>model://chair</uri><name>{}</name><pose>{} 0 0 0 0 0</pose></include>"
    world = load_world(world_file(tmp_path / "worlds", seat.format("a", 1) + seat.format("b", 2)))
    assert [(o.name, o.pose.position) for o in world.obstacles] == [("a/l/c", (1, 0, 0)), ("b/l/c", (2, 0, 0))]
    assert {name: pose.position for name, pose in world.models.items()} == {"a": (1, 0, 0), "b": (2, 0, 0)}


def test_included_model_keeps_its_pose_and_name_unless_overridden(tmp_path, chair):
    obstacle = only_obstacle(world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>"))
    assert (obstacle.name, obstacle.pose.position) == ("chair/l/c", (5, 5, 5))


@pytest.mark.parametrize(
    "uri", ["model://chair/new.sdf", "model:///chair/", "file://{}", "file://{}/new.sdf", "../models/chair"]
)
def test_model_may_be_included_by_any_kind_of_uri(tmp_path, chair, uri):
    include = f"<include><uri>{uri.format(chair)}</uri></include>"
    assert only_obstacle(world_file(tmp_path / "worlds", include)).name == "chair/l/c"


def test_models_beside_a_world_are_found_without_environment_variables(tmp_path, chair, monkeypatch):
    monkeypatch.delenv("GAZEBO_MODEL_PATH")
    include = "<include><uri>model://chair</uri></include>"
    for directory in (tmp_path, tmp_path / "worlds", tmp_path / "models"):
        assert only_obstacle(world_file(directory, include)).name == "chair/l/c"


def test_models_of_ros_packages_are_found_by_package_name_and_exported_path(tmp_path, chair, monkeypatch):
    package = tmp_path / "checkout"
    sdf_file(package / "sdf" / "desk" / "model.sdf", f'<model name="desk">{BOX}</model>')
    (package / "package.xml").write_text(
        '<package format="2"><name>office</name><version>1.0.0</version><description>d</description>'
        '<maintainer email="a@b.c">m</maintainer><license>BSD</license>'
        '<export><gazebo_ros gazebo_model_path="${prefix}/sdf"/></export></package>'
    )
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(package))
    for uri in ("package://office/sdf/desk", "model://office/sdf/desk", "model://desk"):
        assert only_obstacle(world_file(tmp_path / "far", f"<include><uri>{uri}</uri></include>")).name == "desk/l/c"


def test_file_uris_are_also_looked_up_in_the_resource_path(tmp_path, chair, monkeypatch):
    monkeypatch.setenv("GAZEBO_RESOURCE_PATH", str(tmp_path))
    include = "<include><uri>file://models/chair</uri></include>"
    assert only_obstacle(world_file(tmp_path / "far" / "away", include)).name == "chair/l/c"


def test_missing_model_is_reported_with_the_searched_places(tmp_path, chair):
    message = raised_by(world_file(tmp_path / "worlds", "\n<include><uri>model://stool</uri></include>"))
    assert message.startswith(f"{tmp_path}/worlds/w.world:4: 'model://stool' was not found; looked for: ")
    for place in (f"{tmp_path}/models/stool (GAZEBO_MODEL_PATH)", ".gazebo/models/stool", "stool (no such package"):
        assert place in message


def test_error_in_an_included_file_names_that_file_and_the_including_one(tmp_path, chair):
    sdf_file(chair / "new.sdf", '<model name="chair"><lnik name="l"/></model>')
    message = raised_by(world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>"))
    assert message.startswith(f"{chair}/new.sdf:2: in 'chair': <lnik> 'l' in <model> is not supported")
    assert message.endswith(f"; included by {tmp_path}/worlds/w.world:3")


def test_model_that_includes_itself_is_refused_with_a_single_message(tmp_path, chair):
    include = "<include><uri>model://chair</uri></include>"
    sdf_file(chair / "new.sdf", f'<model name="chair">\n{include}</model>')
    world = world_file(tmp_path / "worlds", include)
    file = f"{chair}/new.sdf"
    message = f"{file}:3: in 'chair': 'model://chair' is {file} again, within itself; expected another model"
    assert raised_by(world) == f"{message}; included by {world}:3"
    assert raised_by(str(chair / "new.sdf")) == message


def test_models_that_include_each_other_are_refused_with_the_chain_of_includes(tmp_path, chair):
    desk = tmp_path / "models" / "desk"
    sdf_file(chair / "new.sdf", '<model name="chair"><include><uri>model://desk</uri></include></model>')
    sdf_file(desk / "model.sdf", '<model name="desk">\n\n<include><uri>model://chair</uri></include></model>')
    world = world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>")
    message = raised_by(world)
    assert message.startswith(f"{desk}/model.sdf:4: in 'desk': 'model://chair' is {chair}/new.sdf again, within")
    assert message.endswith(f"; included by {chair}/new.sdf:2; included by {world}:3")


def test_same_model_can_be_included_repeatedly_and_nested(tmp_path, chair):
    seat = "<include><uri>model://chair</uri><name>{}</name></include>"
    body = f'{seat.format("a")}{seat.format("b")}<model name="m">{seat.format("c")}</model>'
    world = load_world(world_file(tmp_path / "worlds", body))
    assert [o.name for o in world.obstacles] == ["a/l/c", "b/l/c", "m/c/l/c"]


def test_models_nested_too_deeply_are_refused(tmp_path):
    body = '<model name="m">' * 30 + "</model>" * 30
    assert "more than 20 models within each other; supported: 20" in raised_by(world_file(tmp_path, body))


def test_model_file_can_be_loaded_as_a_world(chair):
    world = load_world(str(chair / "new.sdf"))
    assert (world.name, [o.name for o in world.obstacles], world.spawn) == ("chair", ["chair/l/c"], Pose2D())


# Models


def test_poses_of_nested_models_compose_and_names_show_the_nesting(tmp_path):
    inner = f'<model name="in"><pose>1 0 0 0 0 0</pose>{BOX}</model>'
    body = f'<model name="out"><static>1</static><pose>0 0 1 0 0 1.5707963267948966</pose>{inner}</model>'
    obstacle = only_obstacle(world_file(tmp_path, body))
    assert obstacle.name == "out/in/l/c"
    assert obstacle.pose.position == pytest.approx((0, 1, 1))
    assert rotation_matrix(obstacle.pose.orientation)[:, 0] == pytest.approx([0, 1, 0])


def test_non_static_model_is_treated_as_static_and_listed_once(tmp_path):
    body = f'<model name="cart">\n{BOX}<model name="load"/></model><model name="wall"><static>1</static></model>'
    world = load_world(world_file(tmp_path, body))
    assert [o.name for o in world.obstacles] == ["cart/l/c"]
    assert world.ignored == ("motion of model 'cart', which is not static (line 3)",)


def test_ignored_elements_of_an_included_file_are_listed_with_that_file(tmp_path, chair):
    sdf_file(chair / "new.sdf", '<model name="chair"><static>1</static><plugin name="p"/></model>')
    world = load_world(world_file(tmp_path / "worlds", "<include><uri>model://chair</uri></include>"))
    assert world.ignored == (f"plugin 'p' ({chair}/new.sdf:2)",)


def test_saved_state_moves_models_and_links_as_in_gazebo(tmp_path):
    still = "<model name='{}'><static>1</static>" + BOX + "</model>"
    state = """<state world_name="w"><sim_time>1 2</sim_time><iterations>3</iterations>
      <insertions/><deletions></deletions>
      <model name="a"><static>1</static><pose frame="">1 2 3 0 0 0</pose><scale>1 1 1</scale><joint name="j"/></model>
      <model name="b"><pose>9 9 9 0 0 0</pose><link name="l"><pose>4 5 6 0 0 0</pose><wrench>0 0 0 0 0 0</wrench></link>
      </model><model name="gone"><pose>0 0 0 0 0 0</pose></model><light name="sun"/></state>"""
    world = load_world(world_file(tmp_path, still.format("a") + still.format("b") + state))
    assert [o.pose.position for o in world.obstacles] == [(1, 2, 3), (4, 5, 6)]
    assert world.ignored == ("state of 'gone', which is not in <world name='w'> (line 7)",)


# Meshes


def test_collada_mesh_is_read_with_unit_scene_and_scale(tmp_path):
    (tmp_path / "t.dae").write_text(TRIANGLE_DAE)
    obstacle = only_obstacle(mesh_world(tmp_path, "t.dae", "<scale>2 1 1</scale>"))
    assert isinstance(obstacle.geometry, Mesh)
    assert obstacle.geometry.corners == pytest.approx(np.array([[[0, 3, 0], [2, 3, 0], [0, 3, 2]]]))
    assert obstacle.geometry.file == str(tmp_path / "t.dae")


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj"])
def test_mesh_of_a_box_equals_the_box_for_scans_and_physics(tmp_path, kind):
    name = "box." + kind[:3]
    trimesh.creation.box((0.5, 1.0, 1.5)).export(str(tmp_path / name), file_type=kind)
    pose = "<pose>1.5 0.2 0.3 0.2 0.3 0.4</pose>"
    box = "<link name='l'><collision name='c'><geometry><box><size>1 1 1.5</size></box></geometry></collision></link>"
    as_box = world_file(tmp_path, f'<model name="m"><static>1</static>{pose}{box}</model>', "box.world")
    as_mesh = mesh_world(tmp_path, name, "<scale>2 1 1</scale>", pose)
    fan = Fan(-3.1, 0.01, 620)
    ends = 5.0 * np.stack([np.cos(np.arange(620)), np.sin(np.arange(620)), np.zeros(620)], axis=1) + [0, 0, 0.182]
    seen, met = [], []
    for path in (as_box, as_mesh):
        world = load_world(path)
        seen.append(fan.cast(np.zeros((1, 3)), Slice(world, 0.182))[0])
        physics = BulletEngine(world, 240, 20, 1.0)
        met.append(bullet_rays(physics, (0.0, 0.0, 0.182), ends))
        physics.close()
    assert np.isfinite(seen[0]).sum() > 50
    np.testing.assert_allclose(seen[1], seen[0], atol=1e-6)
    np.testing.assert_allclose(met[1], met[0], atol=2e-3)


CORNERS = b"v 0 0 0\nv 1 0 0\nv 0 0 1\n"
A, B, C = (0, 0, 0), (1, 0, 0), (0, 0, 1)


@pytest.mark.parametrize(
    ("rest", "expected"),
    [
        (b"f 1 2 3", [(A, B, C)]),
        (b"f 3/9/9 2//9 1/9  # a comment\r\nvt 0\nl 1 2\n\xff", [(C, B, A)]),
        (b"f 1 \\\n2 3\n", [(A, B, C)]),
        (b"\tv\t1\t0\t1\n  f\t1 2 4  # \xe9", [(A, B, (1, 0, 1))]),
        (b"v 1 0 1 0.5 0.5 0.5\nf 1 2 4 3", [(A, B, (1, 0, 1)), (A, (1, 0, 1), C)]),
        (b"f -3 -2 -1\nv 5 0 0\nf -4 -3 -1\nf 1 2 5\nv 6 0 0", [(A, B, C), (A, B, (5, 0, 0)), (A, B, (6, 0, 0))]),
    ],
)
def test_only_vertices_and_faces_of_an_obj_are_read(tmp_path, rest, expected):
    (tmp_path / "m.obj").write_bytes(CORNERS + rest)
    assert only_obstacle(mesh_world(tmp_path, "m.obj")).geometry.corners.tolist() == np.array(expected).tolist()


def test_mesh_larger_than_bullets_triangle_limit_is_complete(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=6, radius=1.0)
    assert len(ball.faces) > 60000
    ball.export(str(tmp_path / "ball.stl"))
    world = load_world(mesh_world(tmp_path, "ball.stl"))
    physics = BulletEngine(world, 240, 20, 1.0)
    turns = np.linspace(0.0, 6.2, 50)
    starts_far = np.stack([3.0 * np.cos(turns), 3.0 * np.sin(turns), np.full(50, 0.1)], axis=1)
    met = [bullet_rays(physics, tuple(start), np.array([[0.0, 0.0, 0.1]]))[0] for start in starts_far.tolist()]
    physics.close()
    assert np.array(met) == pytest.approx(2.0 / 3.0, abs=0.003)
    cut = Slice(world, 0.1)
    assert np.hypot(cut.segments[..., 0], cut.segments[..., 1]) == pytest.approx(np.sqrt(0.99), abs=1e-3)


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_robot_is_stopped_by_a_mesh_where_its_scan_sees_it(tmp_path, burger, drive):
    trimesh.creation.box((0.1, 2.0, 0.6)).export(str(tmp_path / "wall.stl"))
    world = load_world(mesh_world(tmp_path, "wall.stl", pose="<pose>0.5 0 0.3 0 0 0</pose>"))
    sim = make_simulator(SimParams(drive=drive, cmd_vel_timeout=0.0), world, [RobotSpec("", burger, Pose2D())])
    ahead = sim.exact_distances()[0]
    sim.command(Twist2D(0.2))
    for _ in range(240 * 5):
        sim.step({})
    assert ahead == pytest.approx(0.45 + 0.032, abs=0.001)
    assert 0.2 < sim.world_from_footprint().x < 0.45 and sim.touching()
    sim.close()


BROKEN_MESHES = {  # file: (content, what the message must name)
    "empty.stl": (b"", ["empty.stl"]),
    "text.obj": (b"hello", ["text.obj", "triangle"]),
    "nan.obj": (b"v 0 0 0\nv 1 0 0\nv nan 0 1\nf 1 2 3\n", ["nan.obj:3: v is 'nan 0 1', expected 3 finite numbers"]),
    "words.obj": (b"v 0 0 0\nv 1 a 0\n", ["words.obj:2: v is '1 a 0', expected 3 finite numbers"]),
    "flat.obj": (b"v 0 0\n", ["flat.obj:1: v is '0 0', expected 3 finite numbers"]),
    "beyond.obj": (CORNERS + b"f 1 2 9\n", ["beyond.obj:4: f has vertex 9, expected one of the file's 3"]),
    "zero.obj": (CORNERS + b"f 0 1 2\n", ["zero.obj:4: f is '0 1 2', expected 3 or more vertices, whole numbers"]),
    "before.obj": (CORNERS + b"f -4 1 2\n", ["before.obj:4: f is '-4 1 2', expected", "below 0, of the 3 before it"]),
    "part.obj": (CORNERS + b"f 1 2 3.5\n", ["part.obj:4: f is '1 2 3.5', expected 3 or more vertices"]),
    "edge.obj": (CORNERS + b"f 1 2\n", ["edge.obj:4: f is '1 2', expected 3 or more vertices"]),
    "binary.obj": (b"f " + bytes(range(128, 256)) * 9, ["binary.obj:1: f is '\\\\x80", "expected 3 or more vertices"]),
    "cut.dae": (TRIANGLE_DAE[:700].encode(), ["cut.dae", "XML"]),
    "unit.dae": (TRIANGLE_DAE.replace("0.01", "0").encode(), ["unit.dae", "meter='0'"]),
    "entity.dae": (b"<!DOCTYPE COLLADA [<!ENTITY e SYSTEM 'file:///etc/hostname'>]><COLLADA/>", ["DOCTYPE"]),
    "house.fbx": (b"", ["house.fbx", ".dae, .obj, .stl"]),
}


@pytest.mark.parametrize("name", BROKEN_MESHES)
def test_unreadable_mesh_is_refused_with_the_line_that_uses_it(tmp_path, name):
    content, named = BROKEN_MESHES[name]
    (tmp_path / name).write_bytes(content)
    path = mesh_world(tmp_path, name)
    message = raised_by(path)
    assert message.startswith(f"{path}:3: in 'm/l/c': ")
    assert [word for word in named if word not in message] == []


def test_mesh_with_no_extent_along_an_axis_is_refused(tmp_path):
    (tmp_path / "t.dae").write_text(TRIANGLE_DAE)
    assert "<scale> is '1 0 1'" in raised_by(mesh_world(tmp_path, "t.dae", "<scale>1 0 1</scale>"))


def test_ground_plane_needs_no_model_file_and_can_be_renamed(tmp_path):
    include = "<include><uri>model://ground_plane</uri><name>floor</name><pose>0 0 -1 0 0 0</pose></include>"
    obstacle = only_obstacle(world_file(tmp_path, include))
    assert (obstacle.name, obstacle.pose.position) == ("floor/link/collision", (0, 0, -1))
    assert obstacle.geometry == Plane((0.0, 0.0, 1.0))


def test_world_lists_the_poses_of_its_models():
    assert world_named("stage_4").models["pillar_1"].position == (0.4, 0.5, 0.25)
