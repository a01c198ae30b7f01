"""What one step yields: the names of the sensors, what is due, and the measurements."""

from dataclasses import dataclass, field
from typing import Mapping, Sequence

import numpy as np

from ..robot.fleet import Fleet
from ..sensors.camera import CameraImage
from ..sensors.odometry import Odometers

SCAN, ODOM, JOINTS, IMU, GROUND_TRUTH = "scan", "odom", "joints", "imu", "ground_truth"
BUMPER, BATTERY, MAGNETIC_FIELD, CAMERA, TF = "bumper", "battery", "magnetic_field", "camera", "tf"
SENSORS = (SCAN, ODOM, TF, JOINTS, IMU, GROUND_TRUTH, BUMPER, BATTERY, MAGNETIC_FIELD, CAMERA)

Robots = Sequence[int]  # indices
Subscriptions = Mapping[str, Robots]  # sensor -> the robots for which somebody subscribes to it


@dataclass(eq=False)
class Due:
    """What is due on a step; the same object on all steps that are alike, while the subscriptions stay the same."""

    clock: bool = False  # a clock tick: /clock is due
    control: bool = False  # a control tick: the controllers' period is over
    sensors: Subscriptions = field(default_factory=dict)  # those that are due, for whom they are subscribed to


@dataclass(eq=False)
class Observations:
    """The measurements of the last step that had any, all taken at one simulated time; one object, changed in place.

    The rows of the arrays are those of all robots. A row is of this step where its sensor is due for its robot.
    """

    fleet: Fleet  # ground truth
    odometry: Odometers
    map_from_odom: np.ndarray  # (n, 3) x, y [m], yaw [rad]
    joint_angles: np.ndarray  # (n, 2) [rad] as the encoders read them
    imus: np.ndarray  # (n, 10) as sensors.imu describes
    scans: np.ndarray  # ranges (n, n_beams) [m] in base_scan; another array where the number of beams varies
    stamp_ns: int = 0  # simulated time [ns]
    due: Due = field(default_factory=Due)
    bumpers: Mapping[int, bool] = field(default_factory=dict)  # touches anything but the floor
    magnetic_fields: Mapping[int, np.ndarray] = field(default_factory=dict)  # (3,) [T] in imu_link
    images: Mapping[int, CameraImage] = field(default_factory=dict)

    def of(self, sensor: str) -> Robots:
        """The robots for which a sensor is due and subscribed to."""
        return self.due.sensors.get(sensor, ())
