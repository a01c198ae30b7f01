"""The parameters of each component of the simulator: small frozen sets, which SimParams derives from its fields."""

from dataclasses import dataclass
from typing import Optional


@dataclass(frozen=True)
class WorldParams:
    """Which world is simulated, and how."""

    world: str  # name or path of the world, or "random"
    seed: int  # of all noise, and of a random world
    moving: bool  # obstacles that the world file can move do move
    map_resolution: float  # [m] per cell of the published map


@dataclass(frozen=True)
class SpawnParams:
    """Which robots there are and where they start; the texts are parsed by world.spawn."""

    robots: str
    model: str
    spawn: str


@dataclass(frozen=True)
class EngineParams:
    """What a physics engine is created with."""

    engine_kind: str  # "wheels" (Bullet) or "kinematic"
    physics_rate: int  # [Hz]
    solver_iterations: int
    wheel_torque: float  # [Nm] maximum of each wheel motor
    footprint_radius: Optional[float]  # [m] of the disc that a kinematic robot is; None: each model's own
    gui: bool


@dataclass(frozen=True)
class Rates:
    """How often each thing happens or is measured [Hz]; 0 = never."""

    physics: int
    clock: int
    control: int  # lockstep control ticks
    scan: int
    odom: int
    joints: int
    imu: int
    ground_truth: int
    bumper: int
    battery: int
    magnetic_field: int
    camera: int


@dataclass(frozen=True)
class LimitParams:
    """Limits of every robot's base controller; None: each model's own figure."""

    velocity_limits: str  # which of the model's own velocity limits: "teleop" or "firmware"
    max_linear_velocity: Optional[float]  # [m/s]
    max_angular_velocity: Optional[float]  # [rad/s]
    max_linear_acceleration: Optional[float]  # [m/s^2]
    max_angular_acceleration: Optional[float]  # [rad/s^2]
    cmd_vel_timeout: Optional[float]  # [s]; 0: a command stays in force for ever


@dataclass(frozen=True)
class OdometryParams:
    """Update rate and errors of wheel odometry."""

    rate: int  # [Hz]
    wheel_radius_error: float  # relative error of the wheel radius that odometry assumes
    slip: float  # standard deviation of the relative overcount of an encoder
    encoder_tick: float  # [rad]; 0: exact
    source: str = "encoders"  # or "world": the true pose in the world, as Gazebo's odometrySource world


@dataclass(frozen=True)
class ImuNoise:
    """Standard deviations of the IMU's white noise, and the accelerometer's bias."""

    gyro: float  # [rad/s]
    accelerometer: float  # [m/s^2]
    accelerometer_bias: float = 0.0  # [m/s^2] added to each axis


@dataclass(frozen=True)
class FrameNames:
    """TF frames; of several robots, odom, footprint, scan and imu get the robot's name as a prefix."""

    world: str
    map: str
    odom: str
    footprint: str  # base_footprint
    scan: str
    imu: str


@dataclass(frozen=True)
class TimeParams:
    """How simulated time starts and runs."""

    real_time_factor: float  # simulated seconds per wall second; 0: as fast as possible
    start_paused: bool
    reset_time: bool  # ~reset sets simulated time back to zero


@dataclass(frozen=True)
class LockstepParams:
    """Whether simulated time waits for the controllers at each control tick, and for how long."""

    enabled: bool
    control_rate: int  # [Hz]
    timeout: float  # [s, wall]


@dataclass(frozen=True)
class TopicParams:
    """Which optional topics, transforms and services the node offers, and what they carry."""

    localization: str  # map -> odom: "static" at the spawn pose, "truth": corrected from ground truth, "none": not sent
    initialpose: bool  # a pose on initialpose places the robot there
    odom_tf: bool
    ground_truth: bool
    gazebo_services: bool
    publish_map: bool
    gazebo_topics: bool  # /gazebo/model_states, /gazebo/link_states, imu_service
    real_covariances: bool  # odom and imu carry a TurtleBot3's covariances; else those of the simulated noise
