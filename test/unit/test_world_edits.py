"""Models put in, taken out and moved while the simulator runs: scans and both drives follow."""

import math

import numpy as np
import pytest
from support import ORIGIN, world_named

from aro_robocop_goto_as import sdf
from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D, compose3, inverse3
from aro_robocop_goto_as.sdf_world import read_model
from aro_robocop_goto_as.world_edits import requested_model, with_model, with_model_at, without_model

CRATE = b"""<sdf version="1.6"><model name="crate"><static>1</static><link name="l"><pose>0 0 0.25 0 0 0</pose>
<collision name="c"><geometry><box><size>0.4 0.4 0.5</size></box></geometry></collision></link></model></sdf>"""
AHEAD = Pose3D((1.0, 0.0, 0.0))


def crate(name="", pose=AHEAD):
    return read_model(sdf.parse_text(CRATE, "crate.sdf"), name, pose)


def requested(file, name="", xml=""):
    return requested_model(name, xml, file, AHEAD)


def names(world):
    return [obstacle.name for obstacle in world.obstacles]


def test_model_is_put_in_by_its_own_name_or_another():
    world = world_named("empty")
    assert names(with_model(world, crate()))[-1] == "crate/l/c"
    assert names(with_model(world, crate("box")))[-1] == "box/l/c"
    assert with_model(world, crate()).models["crate"] == AHEAD


def test_name_that_is_taken_or_unknown_is_refused_with_what_there_is():
    world = with_model(world_named("empty"), crate())
    with pytest.raises(WorldError, match="there is a model 'crate' already"):
        with_model(world, crate())
    for edit in (lambda: without_model(world, "crat"), lambda: with_model_at(world, "crat", AHEAD)):
        with pytest.raises(WorldError, match="no model 'crat'; there are: ground_plane, crate"):
            edit()


@pytest.fixture
def crate_folder(tmp_path, monkeypatch):
    """A model's folder that GAZEBO_MODEL_PATH leads to, in the directory that the process runs in."""
    home = tmp_path / "models" / "crate"
    home.mkdir(parents=True)
    (home / "crate_1.sdf").write_bytes(CRATE)
    (home / "model.config").write_text("<model><sdf version='1.6'>crate_1.sdf</sdf></model>")
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "models"))
    monkeypatch.chdir(tmp_path)
    return home


@pytest.mark.parametrize("file", [
    "model://crate", "model://crate/", "model://crate/crate_1.sdf", "models/crate", "models/crate/crate_1.sdf", "{}",
    "{}/crate_1.sdf", "file://{}"])
def test_model_to_put_in_is_found_as_an_included_one_is(crate_folder, file):
    model = requested(file.format(crate_folder))
    assert names(model) == ["crate/l/c"] and model.models == {"crate": AHEAD}


def test_file_to_put_in_that_is_not_found_is_told_with_the_places_looked_in(crate_folder):
    with pytest.raises(WorldError) as caught:
        requested("model://stool")
    assert str(caught.value).startswith("file of the request: 'model://stool' was not found; looked for: ")
    assert f"{crate_folder.parent}/stool (GAZEBO_MODEL_PATH)" in str(caught.value)
    with pytest.raises(WorldError, match=r"'stool.sdf' was not found; looked for: /.*stool.sdf \(where the simulator"):
        requested("stool.sdf")
    with pytest.raises(WorldError, match="'https://a.b/stool' is not supported; supported: model://, package://"):
        requested("https://a.b/stool")
    (crate_folder / "model.config").unlink()
    with pytest.raises(WorldError, match=f"but there is no file {crate_folder}/model.sdf"):
        requested("model://crate")


def test_model_to_put_in_is_given_as_xml_or_as_a_file_and_not_as_both(crate_folder):
    assert names(requested("", xml=CRATE.decode())) == ["crate/l/c"]
    for file, xml in (("", ""), ("model://crate", CRATE.decode())):
        with pytest.raises(WorldError, match="expected either xml or file"):
            requested(file, xml=xml)


@pytest.mark.parametrize("name", ["a/b", "/", "a::b", " ", "\t", " crate", "crate\n", "a\0b"])
def test_name_that_would_be_taken_for_several_is_refused(name):
    with pytest.raises(WorldError) as caught:
        requested("", name, CRATE.decode())
    assert str(caught.value) == (f"the name {name!r} of the request: expected printable characters without '/', '::', "
                                 "and spaces at the ends")


@pytest.mark.parametrize("name", ["Crate 2", "crate.2-b_c", "krabička", "a:b"])
def test_name_in_other_letters_is_taken(name):
    assert names(requested("", name, CRATE.decode())) == [f"{name}/l/c"]


def test_models_own_name_is_refused_likewise_unless_the_request_gives_another():
    text = CRATE.decode().replace('name="crate"', 'name="a/b"')
    with pytest.raises(WorldError, match=r"the name 'a/b' of the model in xml of the request: expected .* without '/'"):
        requested("", xml=text)
    assert names(requested("", "crate", text)) == ["crate/l/c"]


def test_only_the_model_of_that_name_is_taken_out():
    world = with_model(with_model(world_named("empty"), crate("box")), crate("box_2"))
    assert names(without_model(world, "box"))[-1] == "box_2/l/c"
    assert set(without_model(world, "box").models) == {"ground_plane", "box_2"}


def test_moved_model_takes_its_collisions_along():
    pose = Pose3D.from_xyz_rpy((2.0, 1.0, 0.1), (0.1, 0.2, 0.3))
    world = with_model_at(with_model(world_named("empty"), crate()), "crate", pose)
    expected = compose3(pose, Pose3D((0.0, 0.0, 0.25)))
    assert world.obstacles[-1].pose.position == pytest.approx(expected.position)
    assert world.obstacles[-1].pose.orientation == pytest.approx(expected.orientation)
    assert world.models["crate"] == pose


def test_model_that_moves_by_script_goes_on_from_where_it_is_set():
    world = with_model_at(world_named("stage_4"), "pillar_1", Pose3D.from_xyz_rpy((1.0, 0.0, 0.25), (0, 0, math.pi)))
    assert [o.at(5.0).position[:2] for o in world.moving()][0] == pytest.approx((1.0, 1.0))
    with pytest.raises(WorldError, match="level"):
        with_model_at(world, "pillar_1", Pose3D.from_xyz_rpy((0, 0, 0), (0.5, 0, 0)))


def test_inverse_pose_undoes_a_pose():
    pose = Pose3D.from_xyz_rpy((1.0, 2.0, 3.0), (0.3, -0.7, 2.0))
    both = compose3(inverse3(pose), pose)
    assert both.position == pytest.approx((0, 0, 0)) and np.abs(both.orientation) == pytest.approx([0, 0, 0, 1])


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_scans_and_robots_meet_what_was_put_in_and_no_longer_what_was_taken_out(simulator, drive):
    sim = simulator("empty", ORIGIN, drive=drive, cmd_vel_timeout=0.0)
    before = sim.world
    assert np.isinf(sim.exact_distances()[0])
    sim.change_world(with_model(sim.world, crate()))
    assert sim.exact_distances()[0] == pytest.approx(0.832)
    sim.command(Twist2D(0.2))
    for _ in range(240 * 6):
        sim.step({})
    assert 0.6 < sim.world_from_base().x < 0.8 and sim.touching()
    sim.change_world(with_model_at(sim.world, "crate", Pose3D((1.5, 0.0, 0.0))))
    for _ in range(240):
        sim.step({})
    assert sim.world_from_base().x > 0.85
    assert sim.exact_distances()[0] == pytest.approx(1.332 - sim.world_from_base().x, abs=1e-3)
    sim.change_world(without_model(sim.world, "crate"))
    assert np.isinf(sim.exact_distances()[0]) and names(sim.world) == names(before)
    for _ in range(240 * 5):
        sim.step({})
    assert sim.world_from_base().x > 1.5


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_reset_keeps_the_world_as_it_was_made(simulator, drive):
    sim = simulator("empty", ORIGIN, drive=drive)
    sim.change_world(with_model(sim.world, crate()))
    sim.reset()
    sim.command(Twist2D(0.2))
    assert sim.exact_distances()[0] == pytest.approx(0.832)
    sim.change_world(without_model(sim.world, "crate"))
    assert np.isinf(sim.exact_distances()[0])
    assert sim.world_from_base() == Pose2D()
