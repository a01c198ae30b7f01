"""Parameters: one frozen dataclass per node, filled only through `from_dict`, which repairs nothing."""

import difflib
import math
from dataclasses import Field, dataclass, field, fields, replace
from typing import Any, Dict, List, Mapping, Optional, Sequence, Type, TypeVar

from .errors import ParameterError
from .sensors.camera import CameraSpec
from .sensors.scan_profiles import PROFILES, LidarSpec, ScanProfile

T = TypeVar("T")


def _param(default: Any, low: Optional[float] = None, high: Optional[float] = None, choices: Sequence[str] = ()) -> Any:
    """A dataclass field with its inclusive bounds or its choices."""
    return field(default=default, metadata={"low": low, "high": high, "choices": tuple(choices)})


def _positive(default: float, high: float = 1e6) -> Any:
    return _param(default, low=1e-9, high=high)


def _problem(spec: "Field[Any]", value: Any) -> Optional[str]:
    """What is wrong with a value for a field, in words, or None."""
    kind = type(spec.default)
    meta = spec.metadata
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if type(value) is not kind:
        return f"expected {kind.__name__}, got {type(value).__name__} {value!r}"
    if kind is float and not math.isfinite(value):
        return f"expected a finite number, got {value!r}"
    low, high, choices = meta.get("low"), meta.get("high"), meta.get("choices")
    if low is not None and value < low:
        return f"expected at least {low:g}, got {value!r}"
    if high is not None and value > high:
        return f"expected at most {high:g}, got {value!r}"
    if choices and value not in choices:
        return "expected one of {}, got {!r}".format(", ".join(choices), value)
    return None


def from_dict(cls: Type[T], raw: Mapping[str, Any], source: str) -> T:
    """A parameter dataclass from plain values; absent keys keep their defaults.

    Raises ParameterError naming `source` (a file or a parameter namespace) and every key that is unknown, of the
    wrong type or out of bounds, with the value found and what was expected.
    """
    specs = {spec.name: spec for spec in fields(cls)}
    problems: List[str] = []
    values: Dict[str, Any] = {}
    for key, value in raw.items():
        if key not in specs:
            close = difflib.get_close_matches(key, specs, n=1)
            hint = f"did you mean {close[0]!r}?" if close else "known are: {}".format(", ".join(sorted(specs)))
            problems.append(f"{key}: unknown parameter; {hint}")
            continue
        problem = _problem(specs[key], value)
        if problem:
            problems.append(f"{key}: {problem}")
        else:
            values[key] = float(value) if isinstance(specs[key].default, float) else value
    if not problems:
        params = cls(**values)
        problems = list(getattr(params, "conflicts", lambda: [])())
    if problems:
        raise ParameterError("{}: {}".format(source, "; ".join(problems)))
    return params


def _bad_frame(name: str, frame: str) -> List[str]:
    """What tf2 would refuse of a frame, in words; empty when all is well."""
    if frame and not frame.startswith("/") and not any(character.isspace() for character in frame):
        return []
    return [f"{name}: expected a frame's name without blank or leading slash, got {frame!r}"]


@dataclass(frozen=True)
class SimParams:
    """Parameters of robocop_sim; config/sim.yaml says what each one means, in which unit and from which source."""

    world: str = "stage_4"
    model: str = "burger"
    spawn: str = ""
    robots: str = ""
    seed: int = _param(1, low=1, high=2**31 - 1)
    gui: bool = False
    localization: str = _param("static", choices=("static", "truth"))
    odom_tf: bool = True
    ground_truth: bool = True
    gazebo_services: bool = False
    moving: bool = False
    publish_map: bool = False
    map_resolution: float = _positive(0.05)

    drive: str = _param("wheels", choices=("wheels", "kinematic"))
    physics_rate: int = _param(240, low=1, high=10000)
    footprint_radius: float = _param(0.0, low=0.0, high=100.0)
    solver_iterations: int = _param(20, low=1, high=10000)
    wheel_torque: float = _positive(1.0)
    real_time_factor: float = _param(1.0, low=0.0, high=1e6)
    clock_rate: int = _param(60, low=1)
    sync: str = _param("free", choices=("free", "lockstep"))
    control_rate: int = _param(10, low=1)
    lockstep_timeout: float = _positive(2.0)
    reset_time: bool = False
    start_paused: bool = False

    cmd_vel_timeout: float = _param(0.5, low=-1.0)
    velocity_limits: str = _param("teleop", choices=("teleop", "firmware"))
    max_linear_velocity: float = _param(0.0, low=0.0, high=1e6)
    max_angular_velocity: float = _param(0.0, low=0.0, high=1e6)
    max_linear_acceleration: float = _param(0.0, low=0.0, high=1e6)
    max_angular_acceleration: float = _param(0.0, low=0.0, high=1e6)

    scan_profile: str = _param("gazebo", choices=tuple(PROFILES))
    scan_rate: int = _param(0, low=0)
    scan_samples: int = _param(0, low=0, high=100000)
    scan_angle_min: float = _param(0.0, low=-10.0, high=10.0)
    scan_angle_max: float = _param(0.0, low=-10.0, high=10.0)
    scan_range_min: float = _param(0.0, low=0.0, high=1e6)
    scan_range_max: float = _param(0.0, low=0.0, high=1e6)
    scan_noise: float = _param(-1.0, low=-1.0, high=100.0)

    covariances: str = _param("gazebo", choices=("gazebo", "real"))
    odom_rate: int = _param(30, low=1)
    odom_wheel_radius_error: float = _param(0.0, low=-0.5, high=0.5)
    odom_slip: float = _param(0.0, low=0.0, high=1.0)
    encoder_tick: float = _param(0.0, low=0.0, high=1.0)
    joint_state_rate: int = _param(30, low=1)
    ground_truth_rate: int = _param(30, low=1)
    imu_rate: int = _param(200, low=1)
    bumper_rate: int = _param(30, low=0)
    battery_state_rate: int = _param(0, low=0)
    magnetic_field_rate: int = _param(0, low=0)
    camera_rate: int = _param(10, low=0)
    camera_width: int = _param(160, low=1, high=4096)
    camera_height: int = _param(120, low=1, high=4096)
    camera_angle: float = _param(1.02974, low=0.01, high=3.0)
    camera_range_min: float = _positive(0.05)
    camera_range_max: float = _positive(10.0)
    gyro_noise: float = _param(2e-4, low=0.0, high=100.0)
    accelerometer_noise: float = _param(1.7e-2, low=0.0, high=100.0)

    world_frame: str = "world"
    map_frame: str = "map"
    odom_frame: str = "odom"
    base_frame: str = "base_footprint"
    scan_frame: str = "base_scan"
    imu_frame: str = "imu_link"

    def given_scan(self) -> Dict[str, Any]:
        """The figures of the scanner that are given, and so win over those of its profile."""
        none = {"scan_noise": -1.0}
        names = [spec.name for spec in fields(self) if spec.name.startswith("scan_")]
        found = {name: getattr(self, name) for name in names if name not in ("scan_profile", "scan_frame")}
        given = {name: value for name, value in found.items() if value != none.get(name, 0)}
        span = ("scan_angle_min", "scan_angle_max")  # one may be 0 as well
        return {**given, **{name: found[name] for name in span if any(end in given for end in span)}}

    def scanner(self) -> ScanProfile:
        """The scanner of this profile, but for what is given."""
        rate, spec = PROFILES[self.scan_profile]
        given = {name[len("scan_"):]: value for name, value in self.given_scan().items()}
        rate = given.pop("rate", rate)
        if "noise" in given:
            given["accuracy"] = ()
        return ScanProfile(rate, replace(spec, **given))

    def camera(self) -> CameraSpec:
        """The camera of those models that have one."""
        return CameraSpec(self.camera_width, self.camera_height, self.camera_angle, self.camera_range_min,
                          self.camera_range_max)

    def conflicts(self) -> List[str]:
        """What can't be true at once, in words; empty when all is well."""
        found = []
        scan_rate, spec = self.scanner()
        rates = {name: getattr(self, name) for name in (
            "clock_rate", "control_rate", "odom_rate", "joint_state_rate", "ground_truth_rate", "bumper_rate",
            "battery_state_rate", "camera_rate")}
        for name, rate in {**rates, "scan_rate": scan_rate}.items():
            if rate and self.physics_rate % rate:
                found.append(f"{name}: {rate} Hz does not divide physics_rate {self.physics_rate} Hz")
        names = [f"{name}_frame" for name in ("world", "map", "odom", "base", "scan", "imu")]
        frames = [getattr(self, name) for name in names]
        for name, frame in zip(names, frames):
            found += _bad_frame(name, frame)
            if frame and frames.count(frame) > 1:
                found.append(f"{name}: expected six different frames, got {frame!r} {frames.count(frame)} times")
        for name in ("imu_rate", "magnetic_field_rate"):
            if getattr(self, name) > self.physics_rate:
                found.append(f"{name}: {getattr(self, name)} Hz is above physics_rate {self.physics_rate} Hz")
        if self.camera_range_max <= self.camera_range_min:
            found.append(f"camera_range_max: expected more than camera_range_min {self.camera_range_min}, "
                         f"got {self.camera_range_max}")
        if -1.0 < self.cmd_vel_timeout < 0.0:
            found.append(f"cmd_vel_timeout: expected at least 0, or -1 for the model's own, got {self.cmd_vel_timeout}")
        return found + self._scan_conflicts(spec)

    def _scan_conflicts(self, spec: LidarSpec) -> List[str]:
        found = []
        if spec.angle_max <= spec.angle_min:
            found.append(f"scan_angle_max: expected more than scan_angle_min {spec.angle_min}, got {spec.angle_max}")
        if spec.range_max <= spec.range_min:
            found.append(f"scan_range_max: expected more than scan_range_min {spec.range_min}, got {spec.range_max}")
        if spec.samples < 2:
            found.append(f"scan_samples: expected at least 2, or 0 for the profile's own, got {spec.samples}")
        if -1.0 < self.scan_noise < 0.0:
            found.append(f"scan_noise: expected at least 0, or -1 for the profile's own, got {self.scan_noise}")
        return found


@dataclass(frozen=True)
class ModelFigures:
    """What a model's drive allows, from config/models/NAME.yaml, which explains each; none may be missing."""

    footprint_radius: float = _param(0.0, high=100.0)
    max_linear_velocity: float = _param(0.0, high=1e6)
    max_angular_velocity: float = _param(0.0, high=1e6)
    firmware_linear_velocity: float = _param(0.0, high=1e6)
    firmware_angular_velocity: float = _param(0.0, high=1e6)
    max_linear_acceleration: float = _param(0.0, high=1e6)
    max_angular_acceleration: float = _param(0.0, high=1e6)
    cmd_vel_timeout: float = _param(0.0, high=1e6)

    def conflicts(self) -> List[str]:
        """Figures that are missing or not positive, in words; empty when all is well."""
        values = {spec.name: getattr(self, spec.name) for spec in fields(self)}
        return [f"{name}: expected a positive number, got {value or 'none'}"
                for name, value in values.items() if value <= 0.0]


@dataclass(frozen=True)
class GotoParams:
    """Parameters of robocop_goto_as; config/goto_as.yaml says what each one means."""

    control_rate: float = _positive(10.0, high=1000.0)
    position_tolerance: float = _positive(0.1)
    angle_tolerance: float = _param(0.1, low=1e-3, high=math.pi)
    obstacle_distance: float = _param(0.3, low=0.0)
    obstacle_half_angle: float = _param(math.pi / 6.0, low=0.0, high=math.pi)

    linear_gain: float = _positive(0.5)
    angular_gain: float = _positive(5.0)
    max_linear_velocity: float = _positive(0.2)
    min_linear_velocity: float = _positive(0.03)
    max_angular_velocity: float = _positive(1.0)
    min_angular_velocity: float = _positive(0.3)
    linear_acceleration: float = _positive(0.5)
    angular_acceleration: float = _positive(3.0)

    data_timeout: float = _positive(1.0)
    stuck_timeout: float = _positive(5.0)
    stuck_distance: float = _positive(0.01)
    stuck_angle: float = _positive(0.05)
    goal_timeout: float = _param(0.0, low=0.0)

    def conflicts(self) -> List[str]:
        """What can't be true at once, in words; empty when all is well."""
        found = []
        for kind in ("linear", "angular"):
            low, high = getattr(self, f"min_{kind}_velocity"), getattr(self, f"max_{kind}_velocity")
            if low > high:
                found.append(f"min_{kind}_velocity: expected at most max_{kind}_velocity {high:g}, got {low:g}")
        return found


@dataclass(frozen=True)
class BridgeParams:
    """Parameters of robocop_rviz_goto_ac; config/rviz_goto_ac.yaml says what each one means."""

    goal_frame: str = "odom"
    default_frame: str = "map"
    transform_timeout: float = _param(1.0, low=0.0)
    status_period: float = _positive(2.0)
    cancel_timeout: float = _positive(2.0)
    ignore_goal_frame: bool = False

    def conflicts(self) -> List[str]:
        """What can't be true at once, in words; empty when all is well."""
        return _bad_frame("goal_frame", self.goal_frame) + _bad_frame("default_frame", self.default_frame)
