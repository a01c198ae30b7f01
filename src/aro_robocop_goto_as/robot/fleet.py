"""All robots of a simulation as arrays, one row per robot, which Python and the compiled functions share."""

import ctypes
import functools
from typing import NamedTuple, Sequence

import numpy as np

from .. import compiled
from ..compiled import address, structure
from ..geometry import Pose2D, Twist2D
from .base_controller import BaseLimits
from .model import Pair, RobotModel

COLUMNS = {"radii": 0, "commands": 2, "commanded_at": 0, "velocities": 2, "targets": 2}
COLUMNS.update(poses=3, twists=2, wheel_angles=2, wheel_speeds=2)

_FleetStruct = structure("robot/fleet.h", "fleet")


class RobotState(NamedTuple):
    """One robot seen from above, after the last step."""

    world_from_footprint: Pose2D
    twist: Twist2D  # true velocity in base_footprint
    wheel_angles: Pair  # left, right [rad], never wrapped
    wheel_speeds: Pair  # left, right [rad/s]


@functools.lru_cache(maxsize=None)
def library() -> ctypes.PyDLL:
    """The compiled functions that take a fleet; InstallationError when they can't be loaded."""
    loaded = compiled.load("fleet", "robot/fleet.h")
    pointer, number, integer = ctypes.c_void_p, ctypes.c_double, ctypes.c_int64
    for name, result, arguments in (
        ("aro_control", ctypes.c_int, [pointer, number, number]),
        ("aro_kinematic_advance", None, [pointer, integer, integer, integer]),
        ("aro_kinematic_push", None, [pointer, number]),
        ("aro_kinematic_touching", ctypes.c_int, [pointer, integer]),
        ("aro_odometry", None, [pointer, pointer, pointer, number]),
    ):
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    return loaded


class Fleet:
    """Commands, base controllers and true states of n robots; rows in the order of the robots, changed in place.

    radii: (n,) [m] of the footprints
    commands, velocities: (n, 2) v [m/s], w [rad/s]: commanded, within the limits, and reached by the base controllers
    commanded_at: (n,) [s] simulated time of the newest command
    targets: (n, 2) wheel speeds [rad/s] that the base controllers ask for, left and right
    poses: (n, 3) world_from_footprint: x, y [m], yaw [rad] within [-pi, pi]
    twists: (n, 2) true velocity in base_footprint: v [m/s], w [rad/s]
    wheel_angles, wheel_speeds: (n, 2) left and right [rad], never wrapped, and [rad/s]
    """

    def __init__(self, models: Sequence[RobotModel], limits: Sequence[BaseLimits], radii: Sequence[float]) -> None:
        """`limits` and `radii` [m]: one for each model."""
        n = len(models)
        self.models = tuple(models)
        self.limits = tuple(limits)
        self._limits = np.array(limits, dtype=float).reshape(n, len(BaseLimits._fields))
        self.wheels = np.array([(model.wheel_radius, model.wheel_separation) for model in models]).reshape(n, 2)
        self.radii = np.array(radii, dtype=float)
        self.commands, self.commanded_at, self.velocities = np.zeros((n, 2)), np.zeros(n), np.zeros((n, 2))
        self.targets, self.poses, self.twists = np.zeros((n, 2)), np.zeros((n, 3)), np.zeros((n, 2))
        self.wheel_angles, self.wheel_speeds = np.zeros((n, 2)), np.zeros((n, 2))
        self.struct = _FleetStruct(
            n,
            address("limits", self._limits, (n, len(BaseLimits._fields))),
            address("wheels", self.wheels, (n, 2)),
            *(
                address(name, getattr(self, name), (n, columns) if columns else (n,))
                for name, columns in COLUMNS.items()
            ),
        )

    def __len__(self) -> int:
        return len(self.models)

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Put a robot at a pose, at rest and without a command; its wheels keep their angles."""
        self.poses[robot] = world_from_footprint
        for rows in (self.commands, self.velocities, self.targets, self.twists, self.wheel_speeds):
            rows[robot] = 0.0
        self.commanded_at[robot] = 0.0

    def pose(self, robot: int) -> Pose2D:
        """A robot's world_from_footprint."""
        return Pose2D(*self.poses[robot].tolist())

    def state(self, robot: int) -> RobotState:
        """The state of one robot, from its row."""
        left, right = self.wheel_angles[robot].tolist()
        left_speed, right_speed = self.wheel_speeds[robot].tolist()
        twist = Twist2D(*self.twists[robot].tolist())
        return RobotState(self.pose(robot), twist, (left, right), (left_speed, right_speed))
