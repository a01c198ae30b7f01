"""Parameters of the simulator: frozen dataclasses that hold every default, and that param_loading fills.

They are grouped by the component that reads them. A field's name is the name of the ROS parameter, whatever
the group; config/sim.yaml documents each one with its unit and source. A default of None means "not given": ROS
parameters can't hold a null, so the key is simply left out.
"""

from dataclasses import dataclass, replace
from typing import Any, Dict, List, Mapping, Optional

from .param_loading import frame_problems, from_dict, group, parameter, positive
from .robot.model_names import DEFAULT_MODEL
from .sensors import camera
from .sensors.scan_profiles import PROFILES, LidarSpec

MODELS_OWN = "the model's value"
PROFILES_OWN = "the profile's value"


@dataclass(frozen=True)
class WorldParams:
    """Which world is simulated, and how."""

    world: str = "stage_4"  # name or path of the world, or "random"
    seed: int = parameter(1, low=1, high=2**31 - 1)  # of all noise, and of a random world
    moving: bool = False  # whether scripted obstacles move
    map_resolution: float = positive(0.05)  # [m] per cell of the published map


@dataclass(frozen=True)
class RobotParams:
    """Which robots there are and where they start; the texts are parsed by world.spawn_texts."""

    model: str = DEFAULT_MODEL
    spawn: str = ""
    robots: str = ""
    footprint_radius: Optional[float] = positive(None, high=100.0, otherwise=MODELS_OWN)  # [m]


@dataclass(frozen=True)
class EngineParams:
    """Which physics engine is used, and its parameters."""

    drive: str = parameter("wheels", choices=("wheels", "kinematic"))  # the engine: Bullet or kinematic
    solver_iterations: int = parameter(20, low=1, high=10000)
    wheel_torque: float = positive(1.0)  # [Nm] maximum of each wheel motor
    gui: bool = False


@dataclass(frozen=True)
class Rates:
    """How often each thing happens or is measured [Hz]; 0 = never. The scanner's is in ScanParams."""

    physics_rate: int = parameter(240, low=1, high=10000)
    clock_rate: int = parameter(60, low=1)
    control_rate: int = parameter(10, low=1)  # lockstep control ticks
    odom_rate: int = parameter(30, low=1)
    joint_state_rate: int = parameter(30, low=1)
    ground_truth_rate: int = parameter(30, low=1)
    imu_rate: int = parameter(200, low=1)
    bumper_rate: int = parameter(30, low=0)
    camera_rate: int = parameter(10, low=0)


@dataclass(frozen=True)
class TimeParams:
    """How simulated time starts and runs."""

    real_time_factor: float = parameter(1.0, low=0.0, high=1e6)  # 0: as fast as possible
    start_paused: bool = False


@dataclass(frozen=True)
class LockstepParams:
    """Whether simulated time waits for the controllers at each control tick, and for how long."""

    sync: str = parameter("free", choices=("free", "lockstep"))
    lockstep_timeout: float = positive(2.0)  # [s, wall]

    @property
    def enabled(self) -> bool:
        """Whether simulated time waits for the controllers."""
        return self.sync == "lockstep"


@dataclass(frozen=True)
class LimitParams:
    """Limits of every robot's base controller; None: each model's own figure."""

    velocity_limits: str = parameter("teleop", choices=("teleop", "firmware"))
    max_linear_velocity: Optional[float] = positive(None, otherwise=MODELS_OWN)  # [m/s]
    max_angular_velocity: Optional[float] = positive(None, otherwise=MODELS_OWN)  # [rad/s]
    max_linear_acceleration: Optional[float] = positive(None, otherwise=MODELS_OWN)  # [m/s^2]
    max_angular_acceleration: Optional[float] = positive(None, otherwise=MODELS_OWN)  # [rad/s^2]
    cmd_vel_timeout: Optional[float] = parameter(None, low=0.0, otherwise=MODELS_OWN)  # [s]; 0: never


@dataclass(frozen=True)
class ScanParams:
    """The laser scanner: a profile, and figures that replace its own."""

    scan_profile: str = parameter("gazebo", choices=tuple(PROFILES))
    scan_rate: Optional[int] = parameter(None, low=1, otherwise=PROFILES_OWN)
    scan_samples: Optional[int] = parameter(None, low=2, high=100000, otherwise=PROFILES_OWN)
    scan_angle_min: Optional[float] = parameter(None, low=-10.0, high=10.0, otherwise=PROFILES_OWN)
    scan_angle_max: Optional[float] = parameter(None, low=-10.0, high=10.0, otherwise=PROFILES_OWN)
    scan_range_min: Optional[float] = parameter(None, low=0.0, high=1e6, otherwise=PROFILES_OWN)
    scan_range_max: Optional[float] = positive(None, otherwise=PROFILES_OWN)
    scan_noise: Optional[float] = parameter(None, low=0.0, high=100.0, otherwise=PROFILES_OWN)

    @property
    def rate(self) -> int:
        """Scans per second [Hz]."""
        return PROFILES[self.scan_profile].rate if self.scan_rate is None else self.scan_rate

    def given(self) -> Dict[str, Any]:
        """The figures that replace the profile's."""
        return {name: value for name, value in vars(self).items() if name != "scan_profile" and value is not None}

    def lidar(self) -> LidarSpec:
        """The scanner of the profile, with the given figures in place of its own."""
        figures = {name[len("scan_") :]: value for name, value in self.given().items() if name != "scan_rate"}
        if "noise" in figures:
            figures["accuracy"] = ()
        return replace(PROFILES[self.scan_profile].spec, **figures)


@dataclass(frozen=True)
class OdometryParams:
    """Errors of wheel odometry."""

    odom_source: str = parameter("encoders", choices=("encoders", "world"))  # world: the true pose, as Gazebo's
    odom_wheel_radius_error: float = parameter(0.0, low=-0.5, high=0.5)  # relative, of the radius that it assumes
    odom_slip: float = parameter(0.0, low=0.0, high=1.0)  # sigma; overcount by |Gaussian|, relative
    encoder_tick: float = parameter(0.0, low=0.0, high=1.0)  # [rad]; 0: exact


@dataclass(frozen=True)
class ImuParams:
    """Standard deviations of the IMU's white noise, and the accelerometer's bias."""

    gyro_noise: float = parameter(2e-4, low=0.0, high=100.0)  # [rad/s]
    accelerometer_noise: float = parameter(1.7e-2, low=0.0, high=100.0)  # [m/s^2]
    accelerometer_bias: float = parameter(0.0, low=-100.0, high=100.0)  # [m/s^2] added to each axis


@dataclass(frozen=True)
class CameraParams:
    """The cameras: a profile, and figures that replace its own."""

    camera_profile: str = parameter("small", choices=tuple(camera.PROFILES))
    camera_width: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_height: Optional[int] = parameter(None, low=1, high=4096, otherwise=PROFILES_OWN)
    camera_angle: Optional[float] = parameter(None, low=0.01, high=3.0, otherwise=PROFILES_OWN)  # [rad]
    camera_range_min: float = positive(0.05)  # [m]
    camera_range_max: float = positive(10.0)  # [m]

    def spec(self, model: str) -> camera.CameraSpec:
        """The camera of a model, by its name."""
        width, height, angle = camera.PROFILES[self.camera_profile].get(model, camera.SMALL)
        return camera.CameraSpec(
            width if self.camera_width is None else self.camera_width,
            height if self.camera_height is None else self.camera_height,
            angle if self.camera_angle is None else self.camera_angle,
            self.camera_range_min,
            self.camera_range_max,
        )


@dataclass(frozen=True)
class FrameNames:
    """TF frames; of several robots, odom, base, scan and imu get the robot's name as a prefix."""

    world_frame: str = "world"
    map_frame: str = "map"
    odom_frame: str = "odom"
    base_frame: str = "base_footprint"
    scan_frame: str = "base_scan"
    imu_frame: str = "imu_link"


@dataclass(frozen=True)
class TopicParams:
    """Which optional topics, transforms and services the node offers, and what they carry."""

    localization: str = parameter("static", choices=("static", "truth", "none"))  # of map -> odom
    initialpose: bool = True  # a pose on initialpose places the robot there, unless localization is left to others
    odom_tf: bool = True
    ground_truth: bool = True
    gazebo_services: bool = False
    gazebo_topics: bool = False  # /gazebo/model_states, /gazebo/link_states, imu_service
    publish_map: bool = False
    covariances: str = parameter("gazebo", choices=("gazebo", "real"))  # of odom and imu; real: a TurtleBot3's

    @property
    def has_initialpose(self) -> bool:
        """Whether initialpose is subscribed to: where amcl localizes, it alone receives that topic."""
        return self.initialpose and self.localization != "none"


@dataclass(frozen=True)
class SimParams:
    """Parameters of robocop_sim."""

    world: WorldParams = group(WorldParams)
    robots: RobotParams = group(RobotParams)
    engine: EngineParams = group(EngineParams)
    rates: Rates = group(Rates)
    time: TimeParams = group(TimeParams)
    lockstep: LockstepParams = group(LockstepParams)
    limits: LimitParams = group(LimitParams)
    scan: ScanParams = group(ScanParams)
    odometry: OdometryParams = group(OdometryParams)
    imu: ImuParams = group(ImuParams)
    camera: CameraParams = group(CameraParams)
    frames: FrameNames = group(FrameNames)
    topics: TopicParams = group(TopicParams)

    @classmethod
    def of(cls, **given: Any) -> "SimParams":
        """These parameters by their ROS names, and the defaults of all others; ParameterError as from_dict."""
        return from_dict(cls, given, "arguments")

    def conflicts(self) -> List[str]:
        """Combinations of values that are impossible, in words; empty when there are none."""
        return self._rate_conflicts() + self._frame_conflicts() + self._range_conflicts()

    def _rate_conflicts(self) -> List[str]:
        problems = []
        physics, others = self.rates.physics_rate, vars(self.rates)
        first = {name: others[name] for name in ("clock_rate", "control_rate")}
        rates: Dict[str, int] = {**first, "scan_rate": self.scan.rate, **others}
        for name, rate in rates.items():
            if name == "imu_rate":  # need not divide physics_rate
                if rate > physics:
                    problems.append(f"{name}: {rate} Hz is above physics_rate {physics} Hz")
            elif rate and physics % rate:
                problems.append(f"{name}: {rate} Hz does not divide physics_rate {physics} Hz")
        if self.lockstep.enabled and self.rates.clock_rate % self.rates.control_rate:
            problems.append(
                f"control_rate: {self.rates.control_rate} Hz does not divide clock_rate {self.rates.clock_rate} Hz; in "
                "lockstep, controllers wake up at clock ticks"
            )
        return problems

    def _frame_conflicts(self) -> List[str]:
        problems = []
        frames: Mapping[str, str] = vars(self.frames)
        for name, frame in frames.items():
            problems += frame_problems(name, frame)
            count = list(frames.values()).count(frame)
            if frame and count > 1:
                problems.append(f"{name}: expected six different frames, got {frame!r} {count} times")
        return problems

    def _range_conflicts(self) -> List[str]:
        lidar, camera = self.scan.lidar(), self.camera
        return [
            f"{high_name}: expected more than {low_name} {low}, got {high}"
            for low_name, low, high_name, high in (
                ("camera_range_min", camera.camera_range_min, "camera_range_max", camera.camera_range_max),
                ("scan_angle_min", lidar.angle_min, "scan_angle_max", lidar.angle_max),
                ("scan_range_min", lidar.range_min, "scan_range_max", lidar.range_max),
            )
            if high <= low
        ]
