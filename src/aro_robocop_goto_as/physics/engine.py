"""What an engine does: move robots through a world, given their wheel speeds, one step at a time.

bullet.py and kinematic.py implement it. Robots are addressed by index, in the order in which they were added.
"""

from typing import Protocol, Sequence

from ..geometry import Pose2D
from ..robot.model import BodyState, Pair, RobotModel, RobotState
from ..world.model import World


class Engine(Protocol):
    """Owned by one thread, which makes all calls."""

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D) -> int:
        """Place a robot at rest on the floor; returns its index."""

    def set_wheel_speeds(self, robot: int, wheel_speeds: Pair) -> None:
        """Target speeds [rad/s] of the left and right wheel from the next step on."""

    def step(self) -> None:
        """Advance all robots by one step, whose length was given to the constructor."""

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at `time` [s]; robots in their way are pushed."""

    def state(self, robot: int) -> RobotState:
        """The robot seen from above, after the last step."""

    def body(self, robot: int) -> BodyState:
        """The robot's base_link in space, after the last step."""

    def touching(self, robot: int) -> bool:
        """Whether the robot touches anything but the floor."""

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
