"""All parameters of the simulator: the groups that its components declare, and which values exclude one another.

A group is a frozen dataclass with every default, bound and meaning. It is beside the component that reads it, or here
if that component is above this module. A field's name is the name of the ROS parameter, whatever the group; param_docs
writes config/sim.yaml from the groups. A default of None means "not given": ROS parameters can't hold a null, so the
key is simply left out.
"""

from dataclasses import dataclass
from typing import Any, List, Optional

from ..param_loading import MODELS_OWN, from_dict, group, parameter, positive
from ..physics.engine import EngineParams
from ..robot.base_controller import LimitParams
from ..robot.model_names import DEFAULT_MODEL
from ..sensors.catalog import SensorParams


@dataclass(frozen=True)
class WorldParams:
    """Which world is simulated, and how."""

    world: str = parameter(
        "stage_4", about='NAME of worlds/NAME.sdf, "random", or the path of an SDF file or of a map\'s YAML'
    )
    seed: int = parameter(1, 1, 2**31 - 1, "of all noise and of a random world; the same seed gives the same noise")
    moving: bool = parameter(False, about="true: scripted obstacles move, such as the cylinders of stage_3 and stage_4")
    map_resolution: float = positive(0.05, "[m] per cell of the published map")


@dataclass(frozen=True)
class RobotParams:
    """Which robots there are, and where they start."""

    model: str = parameter(DEFAULT_MODEL, about="NAME of urdf/NAME.urdf and config/models/NAME.yaml")
    spawn: str = parameter("", about='"x y" or "x y yaw" in the world [m, rad]; empty: the world\'s own')
    robots: str = parameter(
        "",
        about='empty: one, without a namespace; "N": robot_1 to robot_N; or "NAME[:MODEL] X Y [YAW]; ..." in the world',
    )
    footprint_radius: Optional[float] = positive(
        None, "[m] of the disc that represents a kinematic robot", high=100.0, otherwise=MODELS_OWN
    )


@dataclass(frozen=True)
class Rates:
    """The rates [Hz] of everything that is not a sensor."""

    physics_rate: int = parameter(240, 1, 10000, "[Hz] Bullet's default, at which motors and contacts are tuned")
    clock_rate: int = parameter(60, low=1, about="[Hz] of /clock; 60 makes 0.1 s six ticks")
    control_rate: int = parameter(
        10, low=1, about="[Hz] of lockstep's control ticks; in lockstep it divides clock_rate"
    )


@dataclass(frozen=True)
class TimeParams:
    """How simulated time starts and runs."""

    real_time_factor: float = parameter(
        1.0, 0.0, 1e6, "simulated seconds per wall second; 0 = as fast as possible", live=True
    )
    start_paused: bool = parameter(False, about="true: simulated time stays at zero until ~unpause or ~step")


@dataclass(frozen=True)
class LockstepParams:
    """Whether simulated time waits for the controllers at each control tick, and for how long."""

    sync: str = parameter(
        "free",
        choices=("free", "lockstep"),
        about="lockstep: time waits at each control tick for all controllers' answers",
    )
    lockstep_timeout: float = positive(
        2.0, "[s, wall] for a controller that answered the last two ticks; a miss is counted"
    )

    @property
    def enabled(self) -> bool:
        """Return whether simulated time waits for the controllers."""
        return self.sync == "lockstep"


@dataclass(frozen=True)
class TopicParams:
    """Which optional topics, transforms and services the node offers, and what they carry."""

    localization: str = parameter(
        "static",
        choices=("static", "truth", "none"),
        about="map -> odom: static at the spawn pose; truth: always corrected; none: not published, for amcl or SLAM",
    )
    initialpose: bool = parameter(
        True, about="a pose on initialpose (RViz's 2D Pose Estimate) places the robot; never with localization none"
    )
    odom_tf: bool = parameter(True, about="publish odom -> base_footprint on /tf (the original lab did not)")
    gazebo_services: bool = parameter(False, about="offer /gazebo/get_model_state, ...; needs gazebo_msgs, see compat/")
    gazebo_topics: bool = parameter(
        False, about="publish /gazebo/model_states and /gazebo/link_states, offer imu_service"
    )
    publish_map: bool = parameter(
        False,
        about="publish /map, the world's cross-section at the lidar's height; a world made from a map always does",
    )
    covariances: str = parameter(
        "gazebo",
        choices=("gazebo", "real"),
        about="of odom and imu. gazebo: of Gazebo's plugin and of the noise; real: as a TurtleBot3's firmware sends",
    )

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
    topics: TopicParams = group(TopicParams)

    @classmethod
    def of(cls, **given: Any) -> "SimParams":
        """These parameters by their ROS names, and the defaults of all others; ParameterError as from_dict."""
        return from_dict(cls, given, "arguments")

    def conflicts(self) -> List[str]:
        """Combinations of values that are impossible, in words; empty when there are none."""
        return self._rate_conflicts() + self._range_conflicts()

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
