"""Robot descriptions match the manufacturers' data; broken ones are refused."""

from pathlib import Path

import pytest
from support import ROOT, model_named

from aro_robocop_goto_as.errors import RobotModelError
from aro_robocop_goto_as.robot.urdf import load_robot

URDF = Path(ROOT, "urdf", "burger.urdf").read_text()


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ("wheel_left_joint", "wheel_lft_joint", "no joint 'wheel_left_joint'; found: base_joint,"),
        ('link name="base_scan"', 'link name="laser"', "no link 'base_scan'"),
        ('<sphere radius="0.033"/>', '<cylinder radius="0.033" length="0.018"/>', "needs a sphere as its collision"),
        ('<child link="imu_link"/>', '<child link="elsewhere"/>', "no joints lead from link 'imu_link' to"),
        (
            'size="0.140 0.140 0.143"',
            'size="0.140 0 0.143"',
            "size='0.140 0 0.143', expected 3 finite numbers greater than 0",
        ),
        ('xyz="0 0.080 0.023"', 'xyz="0 0,080 0.023"', "xyz='0 0,080 0.023', expected 3 finite numbers"),
        (
            'xyz="0 0.080 0.023"',
            'xyz="0 -0.090 0.023"',
            "expected 'wheel_left_joint' to the left of 'wheel_right_joint'",
        ),
    ],
)
def test_broken_description_is_refused_with_file_and_problem(burger, tmp_path, old, new, expected):
    path = tmp_path / "robot.urdf"
    assert old in URDF
    path.write_text(URDF.replace(old, new))
    with pytest.raises(RobotModelError) as refusal:
        load_robot(str(path), burger.figures)
    assert str(path) in str(refusal.value) and expected in str(refusal.value)


@pytest.mark.parametrize(
    "name, robot, wheel_radius, separation, lift, scan, imu",
    [
        ("burger", "turtlebot3_burger", 0.033, 0.160, 0.010, (-0.032, 0.0, 0.172), (-0.032, 0.0, 0.068)),
        ("burger_rgbd", "turtlebot3_burger", 0.033, 0.160, 0.010, (-0.032, 0.0, 0.172), (-0.032, 0.0, 0.068)),
        ("waffle", "turtlebot3_waffle", 0.033, 0.287, 0.010, (-0.064, 0.0, 0.122), (0.0, 0.0, 0.068)),
        ("waffle_pi", "turtlebot3_waffle_pi", 0.033, 0.287, 0.010, (-0.064, 0.0, 0.122), (0.0, 0.0, 0.068)),
        ("turtlebot2", "turtlebot2", 0.035, 0.230, 0.0102, (0.0, 0.0, 0.150), (0.056, 0.062, 0.0202)),
    ],
)
def test_models_have_their_manufacturers_dimensions(name, robot, wheel_radius, separation, lift, scan, imu):
    model = model_named(name)
    assert (model.name, model.wheel_radius) == (robot, wheel_radius)
    assert model.wheel_separation == pytest.approx(separation)
    assert model.footprint_from_base.position == pytest.approx((0.0, 0.0, lift))
    assert model.base_from_scan.position == pytest.approx(scan)
    assert model.base_from_imu.position == pytest.approx(imu)
