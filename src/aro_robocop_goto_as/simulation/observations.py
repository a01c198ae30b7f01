"""What one step yields: the names of the sensors, and the measurements that were due and subscribed to."""

from dataclasses import dataclass, field
from typing import Mapping, NamedTuple, Sequence

import numpy as np

from ..geometry import Pose2D
from ..robot.model import RobotState
from ..sensors.camera import CameraImage
from ..sensors.imu import ImuSample
from ..sensors.odometry import Odometry

SCAN, ODOM, JOINTS, IMU, GROUND_TRUTH = "scan", "odom", "joints", "imu", "ground_truth"
BUMPER, BATTERY, MAGNETIC_FIELD, CAMERA, TF = "bumper", "battery", "magnetic_field", "camera", "tf"
SENSORS = (SCAN, ODOM, TF, JOINTS, IMU, GROUND_TRUTH, BUMPER, BATTERY, MAGNETIC_FIELD, CAMERA)

Subscriptions = Mapping[str, Sequence[int]]  # sensor -> indices of the robots for which somebody subscribes to it


class RobotTransforms(NamedTuple):
    """The two transforms between a robot and the map."""

    map_from_odom: Pose2D
    odom_from_footprint: Pose2D


@dataclass(frozen=True)
class Observations:
    """The measurements of one step, all taken at one simulated time; each mapping is by the index of the robot.

    A mapping holds the robots that are subscribed to, and is empty on a step on which the sensor is not due.
    """

    stamp_ns: int  # simulated time [ns]
    clock: bool  # a clock tick: /clock is due
    control: bool  # a control tick: the controllers' period is over
    scans: Mapping[int, np.ndarray] = field(default_factory=dict)  # ranges (n_beams,) [m] in base_scan
    odometry: Mapping[int, Odometry] = field(default_factory=dict)
    transforms: Mapping[int, RobotTransforms] = field(default_factory=dict)
    joints: Mapping[int, RobotState] = field(default_factory=dict)  # wheel angles as the encoders read them
    imus: Mapping[int, ImuSample] = field(default_factory=dict)
    ground_truth: Mapping[int, RobotState] = field(default_factory=dict)
    bumpers: Mapping[int, bool] = field(default_factory=dict)  # touches anything but the floor
    batteries: Sequence[int] = ()  # robots whose battery state is due
    magnetic_fields: Mapping[int, np.ndarray] = field(default_factory=dict)  # (3,) [T] in imu_link
    images: Mapping[int, CameraImage] = field(default_factory=dict)

    @property
    def measured(self) -> bool:
        """Whether anything but transforms was measured for any robot."""
        return bool(
            self.scans
            or self.odometry
            or self.joints
            or self.imus
            or self.ground_truth
            or self.bumpers
            or self.batteries
            or self.magnetic_fields
            or self.images
        )
