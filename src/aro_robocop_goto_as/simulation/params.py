"""All parameters of the simulator: the groups that its components declare, and which values exclude one another.

A group is a frozen dataclass with every default and bound. It is beside the component that reads it, or here if that
component is above this module. A field's name is the name of the ROS parameter, whatever the group; config/sim.yaml
documents each one with its unit and source. A default of None means "not given": ROS parameters can't hold a null, so
the key is simply left out.
"""

from dataclasses import dataclass
from typing import Any, List, Mapping, Optional

from ..param_loading import MODELS_OWN, frame_problems, from_dict, group, parameter, positive
from ..physics.engine import EngineParams
from ..robot.base_controller import LimitParams
from ..robot.model_names import DEFAULT_MODEL
from ..sensors.catalog import SensorParams


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
class Rates:
    """The rates [Hz] of everything that is not a sensor."""

    physics_rate: int = parameter(240, low=1, high=10000)
    clock_rate: int = parameter(60, low=1)
    control_rate: int = parameter(10, low=1)  # lockstep control ticks


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
        """Return whether simulated time waits for the controllers."""
        return self.sync == "lockstep"


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
    gazebo_services: bool = False
    gazebo_topics: bool = False  # /gazebo/model_states, /gazebo/link_states, imu_service
    publish_map: bool = False
    covariances: str = parameter("gazebo", choices=("gazebo", "real"))  # of odom and imu; real: a TurtleBot3's

    @property
    def has_initialpose(self) -> bool:
        """Return whether initialpose is subscribed to: where amcl localizes, it alone receives that topic."""
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
    sensors: SensorParams = group(SensorParams)
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
        physics, rates = self.rates.physics_rate, {**vars(self.rates), **self.sensors.rates()}
        imu = rates.pop("imu_rate")  # it need not divide physics_rate
        problems = [
            f"{name}: {rate} Hz does not divide physics_rate {physics} Hz"
            for name, rate in rates.items()
            if rate and physics % rate
        ]
        if imu > physics:
            problems.append(f"imu_rate: {imu} Hz is above physics_rate {physics} Hz")
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
        lidar, camera = self.sensors.lidar.profile(), self.sensors.camera
        return [
            f"{high_name}: expected more than {low_name} {low}, got {high}"
            for low_name, low, high_name, high in (
                ("camera_range_min", camera.camera_range_min, "camera_range_max", camera.camera_range_max),
                ("scan_angle_min", lidar.angle_min, "scan_angle_max", lidar.angle_max),
                ("scan_range_min", lidar.range_min, "scan_range_max", lidar.range_max),
            )
            if high <= low
        ]
