"""The wheels' encoders: joint angles, and odometry with its configured errors, or the true poses in the world."""

import ctypes
from dataclasses import dataclass
from functools import partial
from typing import Callable, Sequence

import numpy as np

from ..compiled import address, structure
from ..geometry import Pose2D, compose, inverse
from ..param_loading import parameter
from ..robot.fleet import library
from .sensor import MeasurementCalls, NoiseStreams, RateParams, RobotIndices, Sensor, SensorContext

ODOM = "odom"

_Odometers = structure("sensors/odometry.c", "odometers")


@dataclass(frozen=True)
class OdometryParams(RateParams):
    """Errors of wheel odometry, and how often it is updated and the joints are read."""

    odom_source: str = parameter(
        "encoders",
        choices=("encoders", "world"),
        about="encoders: integrated from the wheels, from 0 on; world: the true pose, as Gazebo's odometrySource world",
    )
    odom_wheel_radius_error: float = parameter(
        0.0, -0.5, 0.5, "relative, of the radius that odometry assumes; with 0.02 it measures 1.02 m per metre"
    )
    odom_slip: float = parameter(
        0.0, 0.0, 1.0, "sigma of the Gaussian whose absolute value is the encoders' relative overcount at each update"
    )
    encoder_tick: float = parameter(
        0.0, 0.0, 1.0, "[rad] resolution; 0 = exact. TurtleBot3: 0.001533981, 4096 per turn"
    )
    odom_rate: int = parameter(30, low=1, about="[Hz] of odom, and of odom -> base_footprint on /tf")
    joint_state_rate: int = parameter(30, low=1, about="[Hz] of joint_states")


class WheelOdometry(Sensor):
    """One odometry per robot: wheel odometry that starts at zero, or the true pose in the world.

    poses: (n, 3) odom_from_footprint at the latest update: x, y [m], yaw [rad]
    twists: (n, 2) mean velocity since the update before: v [m/s], w [rad/s]
    map_from_odom: (n, 3) x, y [m], yaw [rad]
    update(): bring all these arrays to the fleet's present state
    """

    topic = ODOM
    always_on = True  # it integrates: no update may be left out

    def __init__(self, params: OdometryParams, context: SensorContext, follows_truth: bool = False) -> None:
        """`follows_truth`: whether map_from_odom is corrected with each measurement."""
        n = len(context.fleet)
        super().__init__(context, params.odom_rate)
        self._fleet, self._follows_truth = context.fleet, follows_truth
        self.in_world = params.odom_source == "world"
        self._slips = params.odom_slip > 0.0 and not self.in_world
        self._resolution = params.encoder_tick
        self._wheels = context.fleet.wheels * [1.0 + params.odom_wheel_radius_error, 1.0]
        self.poses, self.twists, self.map_from_odom = np.zeros((n, 3)), np.zeros((n, 2)), np.zeros((n, 3))
        self._read = np.zeros((n, 2))  # encoder angles [rad] at the latest update, in whole multiples of the resolution
        self._counted, self._rolled = np.zeros((n, 2)), np.zeros((n, 2))  # wheel angles with slip, and true ones [rad]
        self._struct = _Odometers(
            n,
            address("wheels", self._wheels, (n, 2)),
            address("poses", self.poses, (n, 3)),
            address("twists", self.twists, (n, 2)),
            address("read", self._read, (n, 2)),
            address("counted", self._counted, (n, 2)),
            address("rolled", self._rolled, (n, 2)),
            params.odom_slip,
            self._resolution,
        )
        self._noise = np.zeros((n, 2))  # standard normal, of the next update if wheels slip
        self.update: Callable[[], object] = self._copy
        if not self.in_world:
            rows = (
                ctypes.addressof(self._struct),
                context.fleet.struct.wheel_angles,
                address("noise", self._noise, (n, 2)),
            )
            self.update = partial(library().aro_odometry, *rows, 1.0 / params.odom_rate)

    def measurement_calls(self, _robots: RobotIndices) -> MeasurementCalls:
        """Update the odometry of all robots."""
        slip, follow = [self._draw_slip] * self._slips, [self._follow_truth] * self._follows_truth
        return MeasurementCalls([*slip, self.update, *follow])

    def reset(self, spawns: Sequence[Pose2D]) -> None:
        """Start at zero, or at the true poses, at the wheels' present angles."""
        self.poses[:], self.twists[:] = 0.0, 0.0
        self._read[:] = self.joint_angles()
        self._counted[:] = self._rolled[:] = self._fleet.wheel_angles
        if self.in_world:
            self.update()
        self.map_from_odom[:] = 0.0 if self.in_world else spawns

    def joint_angles(self) -> np.ndarray:
        """Wheel angles (n, 2) [rad] at the resolution of the encoders, without slip."""
        angles = self._fleet.wheel_angles
        return np.floor(angles / self._resolution) * self._resolution if self._resolution else angles

    def _draw_slip(self) -> None:
        self.context.noise.stream(NoiseStreams.ENCODERS).standard_normal(out=self._noise)

    def _copy(self) -> None:
        self.poses[:], self.twists[:] = self._fleet.poses, self._fleet.twists

    def _follow_truth(self) -> None:
        for robot, pose in enumerate(self.poses.tolist()):
            self.map_from_odom[robot] = compose(self._fleet.pose(robot), inverse(Pose2D(*pose)))

    def pose_now(self, robot: int) -> Pose2D:
        """odom_from_footprint at the present wheel angles, without noise; the arrays stay as they are."""
        rows = (self.poses, self.twists, self._read, self._counted, self._rolled)
        before = [row.copy() for row in rows]
        self._noise[:] = 0.0
        self.update()
        pose = Pose2D(*self.poses[robot].tolist())
        for row, values in zip(rows, before):
            row[:] = values
        return pose


class JointEncoders(Sensor):
    """angles: (n, 2) [rad] of the wheels, left and right, as the encoders read them; speeds: (n, 2) [rad/s], exact."""

    topic = "joint_states"

    def __init__(self, params: OdometryParams, context: SensorContext, odometry: WheelOdometry) -> None:
        super().__init__(context, params.joint_state_rate)
        self.angles, self.speeds = np.zeros((len(context.fleet), 2)), context.fleet.wheel_speeds
        self._odometry = odometry

    def measure(self, _robots: RobotIndices) -> None:
        """Read the joints of all robots."""
        self.angles[:] = self._odometry.joint_angles()
