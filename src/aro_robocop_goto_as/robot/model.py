"""Differential-drive robots: their models and their states."""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np

from ..geometry import Pose2D, Pose3D, Vector3
from ..param_loading import positive
from ..shapes import PlacedShape

WHEEL_JOINTS = ("wheel_left_joint", "wheel_right_joint")  # as the TurtleBot3 drivers name them
BASE = "base_link"
CASTER_PREFIX = "caster"
CAMERA_FRAME = "camera_rgb_optical_frame"  # as the TurtleBot3's camera in Gazebo names it
MIN_HEIGHT = 0.02  # [m] above the floor, where a TurtleBot's bottom plate is: the lowest cross-section of a body
MAX_SPACING = 0.09  # [m] between its cross-sections, from there up to the lidar

Pair = Tuple[float, float]  # left and right wheel


@dataclass(frozen=True)
class ModelFigures:
    """Figures that a URDF does not hold, from config/models/NAME.yaml with the source of each; all are required."""

    footprint_radius: float = positive(high=100.0)
    max_linear_velocity: float = positive()
    max_angular_velocity: float = positive()
    firmware_linear_velocity: float = positive()
    firmware_angular_velocity: float = positive()
    max_linear_acceleration: float = positive()
    max_angular_acceleration: float = positive()
    cmd_vel_timeout: float = positive()


@dataclass(frozen=True)
class RobotModel:
    """A differential-drive robot; base is base_link, footprint is base_footprint on the floor between the wheels."""

    name: str
    physics_urdf: str  # its URDF, rooted at base_link and without massless links and visual meshes
    wheel_radius: float  # [m]
    wheel_separation: float  # [m]
    footprint_from_base: Pose3D
    base_from_scan: Pose3D
    base_from_imu: Pose3D
    base_from_camera: Optional[Pose3D]  # the optical frame; None: no camera
    collisions: Tuple[PlacedShape, ...]  # of all links with mass, poses in base_footprint, wheels at angle zero
    figures: ModelFigures

    def height_of(self, mount: Pose3D) -> float:
        """Height above the floor [m] of something that is mounted at a pose in base_link."""
        return self.footprint_from_base.position[2] + mount.position[2]

    def body_heights(self) -> Tuple[float, ...]:
        """The heights [m] of the cross-sections at which obstacles touch the body; three for a Burger."""
        top = self.height_of(self.base_from_scan)
        count = 1 + max(1, math.ceil((top - MIN_HEIGHT) / MAX_SPACING))
        return tuple(np.linspace(MIN_HEIGHT, top, count).tolist())


@dataclass(frozen=True)
class RobotSpec:
    """One robot of a simulation.

    name: its ROS namespace; empty for a single robot
    spawn: world_from_footprint at the start
    """

    name: str
    model: RobotModel
    spawn: Pose2D


@dataclass(frozen=True)
class BodyState:
    """A robot's base_link in space; velocities are in the world frame."""

    world_from_base: Pose3D
    linear_velocity: Vector3  # [m/s]
    angular_velocity: Vector3  # [rad/s]
