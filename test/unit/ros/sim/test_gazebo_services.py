"""Velocities that Gazebo's services give; the services themselves are tested with a master."""

import importlib
import math
import sys
from types import ModuleType
from typing import Any, Callable, Iterator

import pytest
from support import drive

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.simulation.simulator import Simulator


class _AnyType(ModuleType):
    """Stands for gazebo_msgs.srv, which is built on request only."""

    def __getattr__(self, name: str) -> Any:
        return type(name, (), {})


@pytest.fixture(name="services")
def _services(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    for name in ("gazebo_msgs", "gazebo_msgs.msg", "gazebo_msgs.srv"):
        monkeypatch.setitem(sys.modules, name, _AnyType(name))
    vars(sys.modules["gazebo_msgs"])["srv"] = sys.modules["gazebo_msgs.srv"]
    yield importlib.import_module("aro_robocop_goto_as.ros.sim.gazebo_services")
    for name in ("gazebo_services", "gazebo_properties"):
        sys.modules.pop(f"aro_robocop_goto_as.ros.sim.{name}")


@pytest.mark.parametrize(
    "reference, expected",
    [("", (0.0, 0.2)), ("world", (0.0, 0.2)), ("robot_1", (0.0, 0.0)), ("robot_2", (0.3, 0.0))],
)
def test_velocity_of_a_model_is_in_the_axes_of_its_reference(
    simulator: Callable[..., Simulator], services: Any, reference: str, expected: "tuple[float, float]"
) -> None:
    # Both face along y; the second one backs up.
    ahead, aside = Pose2D(0.0, 0.0, math.pi / 2.0), Pose2D(2.0, 0.0, math.pi / 2.0)
    sim = simulator("empty", ahead, aside, drive="kinematic", max_linear_acceleration=1e3)
    sim.command(Twist2D(-0.1, 0.0), 1)
    drive(sim, Twist2D(0.2, 0.0), 0.1)
    asked = services.GazeboServices.__new__(services.GazeboServices)
    asked._simulator, asked._names = sim, ["robot_1", "robot_2"]
    twist = asked._twist("robot_1", reference)
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx((*expected, 0.0), abs=1e-6)
