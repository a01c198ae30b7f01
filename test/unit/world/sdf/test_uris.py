"""Models are found where Gazebo looks for them."""

import pytest
from sdf_files import BOX, only_obstacle, raised_by, sdf_file, world_file

from aro_robocop_goto_as.world.load import load_world


@pytest.mark.parametrize("uri", ["model://chair/new.sdf", "model:///chair/", "file://{}", "../models/chair"])
def test_model_may_be_included_by_any_kind_of_uri(tmp_path, chair, uri):
    include = f"<include><uri>{uri.format(chair)}</uri></include>"
    assert only_obstacle(world_file(tmp_path / "worlds", include)).name == "chair/l/c"


def test_included_lamps_and_descriptions_of_robots_are_no_obstacles(tmp_path, chair):
    for name, content in (("lamp.sdf", '<sdf version="1.6"><light name="lamp"/></sdf>'), ("arm.urdf", "<robot/>")):
        (chair / name).write_text(content)
    include = (
        "<include><uri>model://chair/lamp.sdf</uri></include>\n<include><uri>model://chair/arm.urdf</uri></include>"
    )
    world = load_world(world_file(tmp_path, include))
    assert world.obstacles == ()
    assert world.approximated == ("an include is left out: 'model://chair/arm.urdf' is a URDF (line 4)",)


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


@pytest.mark.parametrize(
    ("config", "name"),
    [
        ("<model><description>Tea & cake</description><sdf version='1.6'>new.sdf</sdf></model>", "chair"),
        ("<model><name>a</name<author>Jos\xe9</author><sdf version='1.6'>new.sdf</sdf></model>", "chair"),
        ("<!DOCTYPE model><model><sdf version='1.6'>new.sdf</sdf></model>", "default"),
        ("<model><sdf version='1.6'/></model>", "default"),
        ("", "default"),
    ],
)
def test_model_config_that_does_not_name_the_sdf_file_means_model_sdf(tmp_path, chair, config, name):
    sdf_file(chair / "model.sdf", f'<model name="default">{BOX}</model>')
    (chair / "model.config").write_text(config, encoding="latin-1")
    include = "<include><uri>model://chair</uri></include>"
    assert only_obstacle(world_file(tmp_path, include)).name == f"{name}/l/c"


def test_file_uris_are_looked_up_beside_the_worlds_folder_and_in_exported_media_paths(tmp_path, chair, monkeypatch):
    include = "<include><uri>file://models/chair</uri></include>"
    assert only_obstacle(world_file(tmp_path / "worlds", include)).name == "chair/l/c"
    (tmp_path / "package.xml").write_text(
        '<package format="2"><name>shop</name><version>1.0.0</version><description>d</description>'
        '<maintainer email="a@b.c">m</maintainer><license>BSD</license>'
        '<export><gazebo_ros gazebo_media_path="/none:${prefix}"/></export></package>'
    )
    far = world_file(tmp_path / "far" / "away" / "from", include)
    assert "models/chair' was not found" in raised_by(far)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert only_obstacle(far).name == "chair/l/c"
