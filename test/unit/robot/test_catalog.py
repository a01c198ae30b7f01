"""Every model drives accurately, stands upright and still, and is seen with its own shape; others are refused."""

import math

import numpy as np
import pytest
from support import model_named, world_named

from aro_robocop_goto_as.errors import RobocopError, RobotModelError
from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.robot.catalog import load_figures
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams

BURGER_BOX = math.sqrt(0.14 * 0.14 / math.pi)  # [m] radius of the circle of the same area


def _sees(sim, robot):
    return float(sim.exact_distances(robot).min())


@pytest.mark.parametrize("params", [{"drive": "wheels"}, {"drive": "kinematic", "physics_rate": 60, "imu_rate": 60}])
def test_robots_of_different_models_see_each_other_at_their_scanners_heights(params):
    names = ["burger", "waffle", "turtlebot2"]
    places = [Pose2D(0.0, 0.0), Pose2D(0.0, 3.0), Pose2D(0.0, -3.0)]
    robots = [RobotSpec(name, model_named(name), place) for name, place in zip(names, places)]
    sim = make_simulator(SimParams.of(**params), world_named("empty"), robots)  # type: ignore[arg-type]
    # A Burger looks over a Waffle and, at 0.182 m, between the plates of a TurtleBot 2.
    assert _sees(sim, 0) == np.inf
    # A Waffle's scanner, at 0.132 m, sees the Burger's box; the two scanners are 3.2 cm apart in x.
    assert _sees(sim, 1) == pytest.approx(math.hypot(3.0, 0.032) - BURGER_BOX, abs=1e-3)
    # A TurtleBot 2's, at 0.160 m, is below the Burger's scanner (0.166 m) and above its box (0.153 m).
    assert _sees(sim, 2) == np.inf
    sim.close()


@pytest.mark.parametrize("name", ["wafle", "../burger", ""])
def test_unknown_model_is_refused_with_the_known_ones(name):
    with pytest.raises(RobotModelError, match=f"no model {name!r}; known are: burger, burger_rgbd, turtlebot2, waffle"):
        model_named(name)


@pytest.mark.parametrize(
    "text, expected",
    [
        ("footprint_radius: 0.1\n", "max_linear_velocity: missing, expected a number"),
        ("radius: 0.1\n", "radius: unknown parameter"),
        ("- 1\n", "expected lines of 'NAME: VALUE'"),
    ],
)
def test_wrong_or_missing_figures_are_refused_by_name(tmp_path, text, expected):
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(RobocopError) as refusal:
        load_figures(str(path))
    assert str(path) in str(refusal.value) and expected in str(refusal.value)
