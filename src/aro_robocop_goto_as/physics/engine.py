"""The interface of a physics engine, which moves a fleet through a world, one step at a time.

bullet.py and kinematic.py implement it. Robots are addressed by index, in the order of the fleet.
"""

from dataclasses import dataclass
from typing import Protocol, Sequence

from ..geometry import Pose2D
from ..param_loading import parameter, positive
from ..robot.fleet import Fleet
from ..robot.model import BodyState
from ..world.model import World


@dataclass(frozen=True)
class EngineParams:
    """Which physics engine is used, and its parameters."""

    drive: str = parameter(
        "wheels",
        choices=("wheels", "kinematic"),
        about="wheels: Bullet, with motors, contacts and slip; kinematic: an ideal drive, blocked by obstacles",
    )
    solver_iterations: int = parameter(
        20, 1, 10000, "of Bullet; after 2 m straight 0.5 mm and 0.05 degrees from the result of 50, at half the cost"
    )
    wheel_torque: float = positive(1.0, "[Nm] maximum of each wheel motor")
    gui: bool = parameter(False, about="open pybullet's window")


class Engine(Protocol):
    """A physics engine. One thread owns it and makes all calls; reset() has to be the first one."""

    fleet: Fleet

    def advance(self, first: int, steps: int, /) -> None:
        """Advance the base controllers and all robots by a number of steps, from step number `first` on."""

    def update_fleet(self) -> None:
        """Update the fleet's rows to the state after the last step."""

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at `time` [s]; robots in their way are pushed."""

    def body(self, robot: int) -> BodyState:
        """The robot's base_link in space, after the last step."""

    def touching(self, robot: int) -> bool:
        """Return whether the robot touches anything but the floor."""

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Place the robot elsewhere, at rest; its wheels keep their angles."""

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """Start again at time 0: all robots at rest at these poses, wheels at angle 0, obstacles at their start.

        What follows is bit-identical to what followed the first start.
        """

    def change_world(self, world: World, time: float) -> None:
        """Replace the world by another one, with its moving obstacles as they are at `time` [s]."""

    def close(self) -> None:
        """Free the engine's resources."""
