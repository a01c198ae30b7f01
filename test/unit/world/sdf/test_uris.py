"""Models are found where Gazebo looks for them."""

import pytest
from sdf_files import BOX, only_obstacle, raised_by, sdf_file, world_file


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


@pytest.mark.parametrize(
    "broken", ["<description>Tea & cake</description>", "<author></name>", "<name>a</name", "<author>Jos\xe9</author>"]
)
def test_only_the_sdf_entry_of_a_model_config_has_to_be_readable(tmp_path, chair, broken):
    config = chair / "model.config"
    config.write_text(config.read_text().replace("<model>", f"<model>{broken}"), encoding="latin-1")
    include = "<include><uri>model://chair</uri></include>"
    assert only_obstacle(world_file(tmp_path, include)).name == "chair/l/c"


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
