"""The robot description is read, and agrees with the maker's figures."""

from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.errors import RobotModelError
from aro_robocop_goto_as.robot import RobotModel, load_robot

URDF = Path(ROOT, "urdf", "burger.urdf").read_text()


def test_the_burger_has_the_makers_figures(burger: RobotModel) -> None:
    assert (burger.wheel_radius, burger.wheel_separation) == (0.033, pytest.approx(0.160))
    assert burger.footprint_from_base.position == pytest.approx((0.0, 0.0, 0.010))
    assert burger.base_from_scan.position == pytest.approx((-0.032, 0.0, 0.172))
    assert burger.base_from_imu.position == pytest.approx((-0.032, 0.0, 0.068))


def test_links_without_mass_are_left_out_of_physics(burger: RobotModel) -> None:
    assert "base_footprint" in burger.urdf and "base_footprint" not in burger.physics_urdf
    assert "imu_link" not in burger.physics_urdf and "base_scan" in burger.physics_urdf


@pytest.mark.parametrize("old, new, expected", [
    ("wheel_left_joint", "wheel_lft_joint", "no joint 'wheel_left_joint'; found: base_joint,"),
    ('link name="base_scan"', 'link name="laser"', "no link 'base_scan'"),
    ('<sphere radius="0.033"/>', '<cylinder radius="0.033" length="0.018"/>', "needs a sphere as its collision"),
    ('<child link="imu_link"/>', '<child link="elsewhere"/>', "no joints lead from link 'imu_link' to"),
    ("</robot>", "", "robot.urdf"),
])
def test_a_broken_description_is_refused_by_name(tmp_path: Path, old: str, new: str, expected: str) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(URDF.replace(old, new))
    with pytest.raises(RobotModelError) as refusal:
        load_robot(str(path))
    assert str(path) in str(refusal.value) and expected in str(refusal.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(RobotModelError, match="nowhere.urdf"):
        load_robot(str(tmp_path / "nowhere.urdf"))
