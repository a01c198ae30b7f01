"""Models are spawned, moved and deleted while the simulator runs; scans and both engines follow."""

import math

import numpy as np
import pytest
from support import ORIGIN, world_named

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose3D, Twist2D
from aro_robocop_goto_as.reading import parse_xml
from aro_robocop_goto_as.world.edit import requested_model, with_model, with_model_at, without_model
from aro_robocop_goto_as.world.sdf.reader import read_model

CRATE = b"""<sdf version="1.6"><model name="crate"><static>1</static><link name="l"><pose>0 0 0.25 0 0 0</pose>
<collision name="c"><geometry><box><size>0.4 0.4 0.5</size></box></geometry></collision></link></model></sdf>"""
AHEAD = Pose3D((1.0, 0.0, 0.0))
WORLD = "hall.world"  # in the directory that the process runs in


def crate(name="", pose=AHEAD):
    return read_model(parse_xml(CRATE, "crate.sdf", WorldError), name, pose)


def requested(file, name="", xml=""):
    return requested_model(name, xml, file, AHEAD, WORLD)


def names(world):
    return [obstacle.name for obstacle in world.obstacles]


def test_duplicate_or_unknown_name_is_refused_with_the_existing_ones():
    world = with_model(world_named("empty"), crate())
    with pytest.raises(WorldError, match="there is already a model 'crate'; expected another name"):
        with_model(world, crate())
    for edit in (lambda: without_model(world, "crat"), lambda: with_model_at(world, "crat", AHEAD)):
        with pytest.raises(WorldError, match="no model 'crat'; there are: ground_plane, crate"):
            edit()


def test_model_that_the_documentation_puts_in_is_found_from_any_world(tmp_path):
    foreign = requested_model("", "", "model://crate", AHEAD, str(tmp_path / "foreign.world"))
    assert names(foreign) == ["crate/link/collision"]


def test_missing_model_file_is_reported_with_the_searched_places(chair):
    with pytest.raises(WorldError) as caught:
        requested("model://stool")
    assert str(caught.value).startswith("file of the request: 'model://stool' was not found; looked for: ")
    assert f"{chair.parent}/stool (GAZEBO_MODEL_PATH)" in str(caught.value)
    with pytest.raises(WorldError, match=r"'stool.sdf' was not found; looked for: /.*stool.sdf \(beside hall.world\)"):
        requested("stool.sdf")
    with pytest.raises(WorldError, match="'shop://stool' is not supported; supported: model://, package://"):
        requested("shop://stool")
    (chair / "model.config").unlink()
    with pytest.raises(WorldError, match=f"but there is no file {chair}/model.sdf"):
        requested("model://chair")


def test_spawned_model_is_given_either_as_xml_or_as_a_file_that_is_found_as_in_an_include(tmp_path, chair, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for file in ("model://chair", "models/chair"):
        assert names(requested(file)) == ["chair/l/c"] and requested(file).models == {"chair": AHEAD}
    assert names(requested("", xml=CRATE.decode())) == ["crate/l/c"]
    for file, given in (("", ""), ("model://chair", CRATE.decode())):
        with pytest.raises(WorldError, match="expected either xml or file"):
            requested(file, xml=given)


@pytest.mark.parametrize("name", ["a/b", "a::b", " ", " crate", "crate\n", "a\0b"])
def test_name_with_separators_or_outer_spaces_is_refused(name):
    with pytest.raises(WorldError) as caught:
        requested("", name, CRATE.decode())
    assert str(caught.value) == (
        f"the name {name!r} of the request: expected printable characters without '/' or '::', "
        "and without spaces at the ends"
    )


def test_scripted_motion_continues_from_the_pose_a_model_is_moved_to():
    world = with_model_at(world_named("stage_4"), "pillar_1", Pose3D.from_xyz_rpy((1.0, 0.0, 0.25), (0, 0, math.pi)))
    assert [o.at(5.0).position[:2] for o in world.moving()][0] == pytest.approx((1.0, 1.0))
    with pytest.raises(WorldError, match="level"):
        with_model_at(world, "pillar_1", Pose3D.from_xyz_rpy((0, 0, 0), (0.5, 0, 0)))


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_scans_and_contacts_follow_a_model_that_is_spawned_moved_and_deleted(simulator, drive):
    sim = simulator("empty", ORIGIN, drive=drive, cmd_vel_timeout=0.0)
    before = sim.world
    assert np.isinf(sim.exact_distances()[0])
    sim.change_world(with_model(sim.world, crate()))
    assert sim.exact_distances()[0] == pytest.approx(0.832)
    sim.command(Twist2D(0.2))
    for _ in range(240 * 6):
        sim.advance({})
    assert 0.6 < sim.world_from_footprint().x < 0.8 and sim.touching()
    for x in (3.0, 1.5):
        sim.change_world(with_model_at(sim.world, "crate", Pose3D((x, 0.0, 0.0))))
    for _ in range(240):
        sim.advance({})
    assert sim.world_from_footprint().x > 0.85
    assert sim.exact_distances()[0] == pytest.approx(1.332 - sim.world_from_footprint().x, abs=1e-3)
    sim.reset()
    assert sim.exact_distances()[0] == pytest.approx(1.332), "a reset keeps the world as it is"
    sim.command(Twist2D(0.2))
    sim.change_world(without_model(sim.world, "crate"))
    assert np.isinf(sim.exact_distances()[0]) and names(sim.world) == names(before)
    for _ in range(240 * 5):
        sim.advance({})
    assert sim.world_from_footprint().x > 0.9
