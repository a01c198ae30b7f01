"""The parameters of each node: frozen dataclasses that hold every default, and that param_loading fills."""

from dataclasses import dataclass, fields, replace
from typing import Any, Dict, List, Optional

from .component_params import (
    EngineParams,
    FrameNames,
    ImuNoise,
    LimitParams,
    LockstepParams,
    OdometryParams,
    Rates,
    SpawnParams,
    TimeParams,
    TopicParams,
    WorldParams,
)
from .goto_params import GotoParams as GotoParams
from .param_loading import frame_problems, parameter, positive
from .sensors.camera import CameraSpec
from .sensors.camera_profiles import PROFILES as CAMERA_PROFILES
from .sensors.camera_profiles import camera_of
from .sensors.scan_profiles import PROFILES, ScanProfile

MODELS_OWN = "the model's own"
PROFILES_OWN = "the profile's own"
ANY_RATE = ("imu_rate", "magnetic_field_rate")  # need not divide physics_rate


@dataclass(frozen=True)
class SimParams:
    """Parameters of robocop_sim; config/sim.yaml documents each one with its unit and source.

    A default of None means "not given": ROS parameters can't hold a null, so the key is simply left out.
    """

    world: str = "stage_4"
    model: str = "burger"
    spawn: str = ""
    robots: str = ""
    seed: int = parameter(1, low=1, high=2**31 - 1)
    gui: bool = False
    localization: str = parameter("static", choices=("static", "truth", "none"))
    initialpose: bool = True
    odom_tf: bool = True
    ground_truth: bool = True
    gazebo_services: bool = False
    gazebo_topics: bool = False
    moving: bool = False
    publish_map: bool = False
    map_resolution: float = positive(0.05)

    drive: str = parameter("wheels", choices=("wheels", "kinematic"))
    physics_rate: int = parameter(240, low=1, high=10000)
    footprint_radius: Optional[float] = positive(None, high=100.0, otherwise=MODELS_OWN)
    solver_iterations: int = parameter(20, low=1, high=10000)
    wheel_torque: float = positive(1.0)
    real_time_factor: float = parameter(1.0, low=0.0, high=1e6)
    clock_rate: int = parameter(60, low=1)
    sync: str = parameter("free", choices=("free", "lockstep"))
    control_rate: int = parameter(10, low=1)
    lockstep_timeout: float = positive(2.0)
    reset_time: bool = False
    start_paused: bool = False

    cmd_vel_timeout: Optional[float] = parameter(None, low=0.0, otherwise=MODELS_OWN)
    velocity_limits: str = parameter("teleop", choices=("teleop", "firmware"))
    max_linear_velocity: Optional[float] = positive(None, otherwise=MODELS_OWN)
    max_angular_velocity: Optional[float] = positive(None, otherwise=MODELS_OWN)
    max_linear_acceleration: Optional[float] = positive(None, otherwise=MODELS_OWN)
    max_angular_acceleration: Optional[float] = positive(None, otherwise=MODELS_OWN)

    scan_profile: str = parameter("gazebo", choices=tuple(PROFILES))
    scan_rate: Optional[int] = parameter(None, low=1, otherwise=PROFILES_OWN)
    scan_samples: Optional[int] = parameter(None, low=2, high=100000, otherwise=PROFILES_OWN)
    scan_angle_min: Optional[float] = parameter(None, low=-10.0, high=10.0, otherwise=PROFILES_OWN)
    scan_angle_max: Optional[float] = parameter(None, low=-10.0, high=10.0, otherwise=PROFILES_OWN)
    scan_range_min: Optional[float] = parameter(None, low=0.0, high=1e6, otherwise=PROFILES_OWN)
    scan_range_max: Optional[float] = positive(None, otherwise=PROFILES_OWN)
    scan_noise: Optional[float] = parameter(None, low=0.0, high=100.0, otherwise=PROFILES_OWN)

    covariances: str = parameter("gazebo", choices=("gazebo", "real"))
    odom_source: str = parameter("encoders", choices=("encoders", "world"))
    odom_rate: int = parameter(30, low=1)
    odom_wheel_radius_error: float = parameter(0.0, low=-0.5, high=0.5)
    odom_slip: float = parameter(0.0, low=0.0, high=1.0)
    encoder_tick: float = parameter(0.0, low=0.0, high=1.0)
    joint_state_rate: int = parameter(30, low=1)
    ground_truth_rate: int = parameter(30, low=1)
    imu_rate: int = parameter(200, low=1)
    bumper_rate: int = parameter(30, low=0)
    battery_state_rate: int = parameter(0, low=0)
    magnetic_field_rate: int = parameter(0, low=0)
    camera_rate: int = parameter(10, low=0)
    camera_profile: str = parameter("small", choices=tuple(CAMERA_PROFILES))
    camera_width: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_height: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_angle: Optional[float] = parameter(None, low=0.01, high=3.0, otherwise=PROFILES_OWN)
    camera_range_min: float = positive(0.05)
    camera_range_max: float = positive(10.0)
    gyro_noise: float = parameter(2e-4, low=0.0, high=100.0)
    accelerometer_noise: float = parameter(1.7e-2, low=0.0, high=100.0)
    accelerometer_bias: float = parameter(0.0, low=-100.0, high=100.0)

    world_frame: str = "world"
    map_frame: str = "map"
    odom_frame: str = "odom"
    base_frame: str = "base_footprint"
    scan_frame: str = "base_scan"
    imu_frame: str = "imu_link"

    def world_params(self) -> WorldParams:
        """Of the world."""
        return WorldParams(self.world, self.seed, self.moving, self.map_resolution)

    def spawn_params(self) -> SpawnParams:
        """Of the robots and their starting poses."""
        return SpawnParams(self.robots, self.model, self.spawn)

    def engine(self) -> EngineParams:
        """Of the physics engine."""
        return EngineParams(
            engine_kind=self.drive,
            physics_rate=self.physics_rate,
            solver_iterations=self.solver_iterations,
            wheel_torque=self.wheel_torque,
            footprint_radius=self.footprint_radius,
            gui=self.gui,
        )

    def rates(self) -> Rates:
        """All rates, the scanner's included."""
        return Rates(
            physics=self.physics_rate,
            clock=self.clock_rate,
            control=self.control_rate,
            scan=self.scanner().rate,
            odom=self.odom_rate,
            joints=self.joint_state_rate,
            imu=self.imu_rate,
            ground_truth=self.ground_truth_rate,
            bumper=self.bumper_rate,
            battery=self.battery_state_rate,
            magnetic_field=self.magnetic_field_rate,
            camera=self.camera_rate,
        )

    def limits(self) -> LimitParams:
        """Of the base controllers."""
        return LimitParams(
            velocity_limits=self.velocity_limits,
            max_linear_velocity=self.max_linear_velocity,
            max_angular_velocity=self.max_angular_velocity,
            max_linear_acceleration=self.max_linear_acceleration,
            max_angular_acceleration=self.max_angular_acceleration,
            cmd_vel_timeout=self.cmd_vel_timeout,
        )

    def odometry(self) -> OdometryParams:
        """Of wheel odometry."""
        return OdometryParams(
            self.odom_rate, self.odom_wheel_radius_error, self.odom_slip, self.encoder_tick, self.odom_source
        )

    def imu_noise(self) -> ImuNoise:
        """Of the IMU."""
        return ImuNoise(self.gyro_noise, self.accelerometer_noise, self.accelerometer_bias)

    def frames(self) -> FrameNames:
        """Names of all frames."""
        return FrameNames(
            self.world_frame, self.map_frame, self.odom_frame, self.base_frame, self.scan_frame, self.imu_frame
        )

    def time(self) -> TimeParams:
        """Of simulated time."""
        return TimeParams(self.real_time_factor, self.start_paused, self.reset_time)

    def lockstep(self) -> LockstepParams:
        """Of lockstep mode."""
        return LockstepParams(self.sync == "lockstep", self.control_rate, self.lockstep_timeout)

    def topics(self) -> TopicParams:
        """Of optional topics, transforms and services."""
        return TopicParams(
            localization=self.localization,
            initialpose=self.initialpose and self.localization != "none",
            odom_tf=self.odom_tf,
            ground_truth=self.ground_truth,
            gazebo_services=self.gazebo_services,
            publish_map=self.publish_map,
            gazebo_topics=self.gazebo_topics,
            real_covariances=self.covariances == "real",
        )

    def given_scan(self) -> Dict[str, Any]:
        """The scan parameters that are given, and so win over the figures of the scan profile."""
        names = [spec.name for spec in fields(self) if spec.name.startswith("scan_") and spec.default is None]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def scanner(self) -> ScanProfile:
        """The scan profile, with the figures that are given in place of its own."""
        rate, spec = PROFILES[self.scan_profile]
        given = {name[len("scan_") :]: value for name, value in self.given_scan().items()}
        rate = given.pop("rate", rate)
        if "noise" in given:
            given["accuracy"] = ()
        return ScanProfile(rate, replace(spec, **given))

    def camera(self, model: str) -> CameraSpec:
        """The camera of a model, by its name: the profile's figures, and those that are given in their place."""
        width, height, angle = camera_of(self.camera_profile, model)
        return CameraSpec(
            width if self.camera_width is None else self.camera_width,
            height if self.camera_height is None else self.camera_height,
            angle if self.camera_angle is None else self.camera_angle,
            self.camera_range_min,
            self.camera_range_max,
        )

    def conflicts(self) -> List[str]:
        """Combinations of values that are impossible, in words; empty when there are none."""
        return self._rate_conflicts() + self._frame_conflicts() + self._range_conflicts()

    def _rate_conflicts(self) -> List[str]:
        problems = []
        names = [spec.name for spec in fields(self) if spec.name.endswith("_rate") and spec.name != "physics_rate"]
        for name in names:
            rate = self.scanner().rate if name == "scan_rate" else getattr(self, name)
            if name in ANY_RATE:
                if rate > self.physics_rate:
                    problems.append(f"{name}: {rate} Hz is above physics_rate {self.physics_rate} Hz")
            elif rate and self.physics_rate % rate:
                problems.append(f"{name}: {rate} Hz does not divide physics_rate {self.physics_rate} Hz")
        if self.sync == "lockstep" and self.clock_rate % self.control_rate:
            problems.append(
                f"control_rate: {self.control_rate} Hz does not divide clock_rate {self.clock_rate} Hz; in lockstep, "
                "controllers wake up at clock ticks"
            )
        return problems

    def _frame_conflicts(self) -> List[str]:
        problems = []
        names = [spec.name for spec in fields(self) if spec.name.endswith("_frame")]
        frames = [getattr(self, name) for name in names]
        for name, frame in zip(names, frames):
            problems += frame_problems(name, frame)
            if frame and frames.count(frame) > 1:
                problems.append(f"{name}: expected six different frames, got {frame!r} {frames.count(frame)} times")
        return problems

    def _range_conflicts(self) -> List[str]:
        scan = self.scanner().spec
        return [
            f"{high_name}: expected more than {low_name} {low}, got {high}"
            for low_name, low, high_name, high in (
                ("camera_range_min", self.camera_range_min, "camera_range_max", self.camera_range_max),
                ("scan_angle_min", scan.angle_min, "scan_angle_max", scan.angle_max),
                ("scan_range_min", scan.range_min, "scan_range_max", scan.range_max),
            )
            if high <= low
        ]


@dataclass(frozen=True)
class BridgeParams:
    """Parameters of robocop_rviz_goto_ac; config/rviz_goto_ac.yaml documents each one."""

    goal_frame: str = "odom"
    default_frame: str = "map"
    transform_timeout: float = parameter(1.0, low=0.0)
    status_period: float = positive(2.0)
    cancel_timeout: float = positive(2.0)
    ignore_goal_frame: bool = False

    def conflicts(self) -> List[str]:
        """Frame names that tf2 would refuse, in words; empty when there are none."""
        return frame_problems("goal_frame", self.goal_frame) + frame_problems("default_frame", self.default_frame)


@dataclass(frozen=True)
class WebParams:
    """Arguments of robocop_web, given as NAME:=VALUE; docs/web.md documents each one."""

    web_host: str = "127.0.0.1"
    web_port: int = parameter(8080, low=1, high=65535)
    web_frame: str = "map"
    web_origins: str = ""
    web_linear_velocity: float = positive(0.2, high=100.0)
    web_angular_velocity: float = positive(1.0, high=100.0)
    replay: str = ""
    replay_speed: float = parameter(1.0, low=0.1, high=10.0)
    view_only: bool = False

    def conflicts(self) -> List[str]:
        """A frame name that tf2 would refuse, in words; empty when there is none."""
        return frame_problems("web_frame", self.web_frame)
