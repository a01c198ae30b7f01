"""Robot descriptions match the manufacturers' data; broken ones are refused."""

from pathlib import Path

import pytest
from support import ROOT, model_named

from aro_robocop_goto_as.errors import RobocopError, RobotModelError
from aro_robocop_goto_as.geometry import Vector3
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.robot.base_controller import limits_from
from aro_robocop_goto_as.robot.catalog import load_figures
from aro_robocop_goto_as.robot.model import RobotModel, load_robot

URDF = Path(ROOT, "urdf", "burger.urdf").read_text()


def test_burger_has_the_manufacturers_dimensions(burger: RobotModel) -> None:
    assert (burger.wheel_radius, burger.wheel_separation) == (0.033, pytest.approx(0.160))
    assert burger.footprint_from_base.position == pytest.approx((0.0, 0.0, 0.010))
    assert burger.base_from_scan.position == pytest.approx((-0.032, 0.0, 0.172))
    assert burger.base_from_imu.position == pytest.approx((-0.032, 0.0, 0.068))


def test_links_without_mass_are_excluded_from_physics(burger: RobotModel) -> None:
    assert "base_footprint" in burger.urdf and "base_footprint" not in burger.physics_urdf
    assert "imu_link" not in burger.physics_urdf and "base_scan" in burger.physics_urdf


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ("wheel_left_joint", "wheel_lft_joint", "no joint 'wheel_left_joint'; found: base_joint,"),
        ('link name="base_scan"', 'link name="laser"', "no link 'base_scan'"),
        ('<sphere radius="0.033"/>', '<cylinder radius="0.033" length="0.018"/>', "needs a sphere as its collision"),
        ('<child link="imu_link"/>', '<child link="elsewhere"/>', "no joints lead from link 'imu_link' to"),
        ("</robot>", "", "robot.urdf"),
    ],
)
def test_broken_description_is_refused_with_file_and_problem(
    burger: RobotModel, tmp_path: Path, old: str, new: str, expected: str
) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(URDF.replace(old, new))
    with pytest.raises(RobotModelError) as refusal:
        load_robot(str(path), burger.figures)
    assert str(path) in str(refusal.value) and expected in str(refusal.value)


def test_a_missing_file_is_named(burger: RobotModel, tmp_path: Path) -> None:
    with pytest.raises(RobotModelError, match="nowhere.urdf"):
        load_robot(str(tmp_path / "nowhere.urdf"), burger.figures)


@pytest.mark.parametrize(
    "name, robot, wheel_radius, separation, lift, scan, imu",
    [
        ("burger_rgbd", "turtlebot3_burger", 0.033, 0.160, 0.010, (-0.032, 0.0, 0.172), (-0.032, 0.0, 0.068)),
        ("waffle", "turtlebot3_waffle", 0.033, 0.287, 0.010, (-0.064, 0.0, 0.122), (0.0, 0.0, 0.068)),
        ("waffle_pi", "turtlebot3_waffle_pi", 0.033, 0.287, 0.010, (-0.064, 0.0, 0.122), (0.0, 0.0, 0.068)),
        ("turtlebot2", "turtlebot2", 0.035, 0.230, 0.0102, (0.0, 0.0, 0.150), (0.056, 0.062, 0.0202)),
    ],
)
def test_other_models_have_their_manufacturers_dimensions(
    name: str, robot: str, wheel_radius: float, separation: float, lift: float, scan: Vector3, imu: Vector3
) -> None:
    model = model_named(name)
    assert (model.name, model.wheel_radius) == (robot, wheel_radius)
    assert model.wheel_separation == pytest.approx(separation)
    assert model.footprint_from_base.position == pytest.approx((0.0, 0.0, lift))
    assert model.base_from_scan.position == pytest.approx(scan)
    assert model.base_from_imu.position == pytest.approx(imu)


@pytest.mark.parametrize(
    "name, limits",
    [
        ("burger", (0.22, 2.84, 2.5, 3.2, 0.5)),
        ("burger_rgbd", (0.22, 2.84, 2.5, 3.2, 0.5)),
        ("waffle", (0.26, 1.82, 2.5, 3.2, 0.5)),
        ("waffle_pi", (0.26, 1.82, 2.5, 3.2, 0.5)),
        ("turtlebot2", (1.5, 6.6, 1.0, 2.0, 0.6)),
    ],
)
def test_limits_are_the_models_unless_a_parameter_overrides_them(name: str, limits: "tuple[float, ...]") -> None:
    figures = model_named(name).figures
    assert limits_from(SimParams().limits(), figures) == limits
    assert limits_from(SimParams(max_linear_velocity=0.1).limits(), figures) == (0.1, *limits[1:])


def test_burger_rgbd_differs_from_burger_only_by_its_camera(burger: RobotModel) -> None:
    head = URDF[URDF.index("<robot") : URDF.index("</robot>")]
    assert head in Path(ROOT, "urdf", "burger_rgbd.urdf").read_text()
    assert model_named("burger_rgbd").figures == burger.figures


def test_every_description_has_a_file_of_figures() -> None:
    urdfs = {path.stem for path in Path(ROOT, "urdf").glob("*.urdf")}
    assert urdfs == {path.stem for path in Path(ROOT, "config", "models").glob("*.yaml")}


@pytest.mark.parametrize("name", ["wafle", "../burger", ""])
def test_unknown_model_is_refused_with_the_known_ones(name: str) -> None:
    with pytest.raises(RobotModelError, match=f"no model {name!r}; known are: burger, burger_rgbd, turtlebot2, waffle"):
        model_named(name)


@pytest.mark.parametrize(
    "text, expected",
    [
        ("footprint_radius: 0.1\n", "max_linear_velocity: missing, expected float"),
        ("radius: 0.1\n", "radius: unknown parameter"),
        ("- 1\n", "expected lines of 'NAME: VALUE'"),
        ("a: [\n", "while parsing"),
    ],
)
def test_wrong_or_missing_figures_are_refused_by_name(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(RobocopError) as refusal:
        load_figures(str(path))
    assert str(path) in str(refusal.value) and expected in str(refusal.value)
