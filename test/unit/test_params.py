"""Parameters are accepted unchanged or refused by name; the config files document all of them."""

import dataclasses
import math
import os
import re
from typing import Any, Dict

import pytest
import yaml
from support import ROOT

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.params import BridgeParams, GotoParams, SimParams

CONFIGS = [("sim.yaml", SimParams), ("goto_as.yaml", GotoParams), ("rviz_goto_ac.yaml", BridgeParams)]


def documented(name: str) -> Dict[str, str]:
    """Key -> default, as a config file shows them in its commented-out lines, each with an explanation."""
    with open(os.path.join(ROOT, "config", name)) as stream:
        lines = [re.match(r"#(\w+): (\S.*?) +# \S", line) for line in stream if re.match(r"#?\w", line)]
    assert all(lines), "every key is commented out and explained"
    return {line[1]: line[2] for line in lines if line}


@pytest.mark.parametrize("name, cls", CONFIGS)
def test_a_config_file_documents_every_parameter_with_its_default_and_sets_none(name: str, cls: Any) -> None:
    with open(os.path.join(ROOT, "config", name)) as stream:
        assert yaml.safe_load(stream) is None
    defaults = {key: yaml.safe_load(text) for key, text in documented(name).items()}
    assert defaults.keys() == {field.name for field in dataclasses.fields(cls)}
    given = {key: value for key, value in defaults.items() if not str(value).startswith("<")}
    assert from_dict(cls, given, name) == cls()
    assert {key for key in defaults if getattr(cls(), key) is None} == defaults.keys() - given.keys()


def test_a_placeholder_for_a_default_is_refused_as_a_value() -> None:
    with pytest.raises(
        ParameterError, match="scan_rate: expected int, got str .*; leave the key out for the profile's"
    ):
        from_dict(SimParams, {"scan_rate": documented("sim.yaml")["scan_rate"]}, "sim.yaml")


def test_rates_of_the_kinematic_configuration_are_consistent() -> None:
    with open(os.path.join(ROOT, "config", "kinematic.yaml")) as stream:
        raw = yaml.safe_load(stream)
    assert from_dict(SimParams, {**raw, "drive": "kinematic"}, "kinematic.yaml").physics_rate == 30


@pytest.mark.parametrize(
    "raw, expected",
    [
        ({"wrold": "stage_1"}, "wrold: unknown parameter; did you mean 'world'?"),
        ({"zzz": 1}, "zzz: unknown parameter; known are: accelerometer_bias, "),
        ({"scan_rate": "10"}, "scan_rate: expected int, got str '10'"),
        ({"scan_rate": 10.0}, "scan_rate: expected int, got float 10.0"),
        ({"gui": 1}, "gui: expected bool, got int 1"),
        ({"seed": True}, "seed: expected int, got bool True"),
        (
            {"cmd_vel_timeout": -2.0},
            "cmd_vel_timeout: expected at least 0, got -2.0; leave the key out for the model's own",
        ),
        (
            {"cmd_vel_timeout": -1},
            "cmd_vel_timeout: expected at least 0, got -1.0; leave the key out for the model's own",
        ),
        ({"max_linear_velocity": 0}, "expected at least 1e-09, got 0.0; leave the key out for the model's own"),
        ({"footprint_radius": 0.0}, "footprint_radius: expected at least 1e-09, got 0.0; leave the key out for"),
        ({"scan_rate": 0}, "scan_rate: expected at least 1, got 0; leave the key out for the profile's own"),
        ({"scan_noise": -1.0}, "scan_noise: expected at least 0, got -1.0; leave the key out for the profile's own"),
        ({"scan_angle_max": None}, "scan_angle_max: expected float, got NoneType None; leave the key out for"),
        ({"max_linear_velocity": 10**400}, "max_linear_velocity: expected a finite number, got inf"),
        ({"seed": 10**22}, "seed: expected at most 2.14748e+09, got 10000000000000000000000"),
        ({"magnetic_field_rate": 300}, "magnetic_field_rate: 300 Hz is above physics_rate 240 Hz"),
        ({"scan_noise": math.nan}, "scan_noise: expected a finite number, got nan"),
        ({"localization": "gps"}, "localization: expected one of static, truth, none, got 'gps'"),
        ({"scan_rate": 7}, "scan_rate: 7 Hz does not divide physics_rate 240 Hz"),
        ({"imu_rate": 300}, "imu_rate: 300 Hz is above physics_rate 240 Hz"),
        ({"scan_range_max": 0.1}, "scan_range_max: expected more than scan_range_min 0.12, got 0.1"),
        ({"solver_iterations": 10**9}, "solver_iterations: expected at most 10000, got 1000000000"),
        ({"max_linear_velocity": 1e300}, "max_linear_velocity: expected at most 1e+06, got 1e+300"),
        ({"odom_frame": "/odom"}, "odom_frame: expected a frame name without blanks or a leading slash, got '/odom'"),
        ({"map_frame": ""}, "map_frame: expected a frame name without blanks or a leading slash, got ''"),
        ({"map_frame": "odom"}, "map_frame: expected six different frames, got 'odom' 2 times"),
        ({"camera_range_min": 20}, "camera_range_max: expected more than camera_range_min 20.0, got 10.0"),
        ({"scan_profile": "lds03"}, "scan_profile: expected one of gazebo, ideal, lds01, lds02, got 'lds03'"),
        (
            {"scan_profile": "lds01", "scan_range_min": 4},
            "scan_range_max: expected more than scan_range_min 4.0, got 3.5",
        ),
        ({"scan_profile": "lds01", "physics_rate": 12}, "scan_rate: 5 Hz does not divide physics_rate 12 Hz"),
        ({"scan_samples": 1}, "scan_samples: expected at least 2, got 1; leave the key out for the profile's own"),
        ({"scan_noise": -0.5}, "scan_noise: expected at least 0, got -0.5; leave the key out for the profile's own"),
        ({"scan_angle_max": -1}, "scan_angle_max: expected more than scan_angle_min 0.0, got -1.0"),
    ],
)
def test_a_wrong_parameter_is_refused_with_source_key_value_and_expectation(raw: Dict[str, Any], expected: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        from_dict(SimParams, raw, "sim.yaml")
    assert str(refusal.value).startswith("sim.yaml: ")
    assert expected in str(refusal.value)


def test_all_wrong_parameters_are_named_at_once() -> None:
    with pytest.raises(ParameterError, match="(?s)scan_rate.*seed"):
        from_dict(SimParams, {"scan_rate": -1, "seed": -1}, "sim.yaml")


def test_an_integer_is_accepted_for_a_float() -> None:
    assert from_dict(SimParams, {"real_time_factor": 2}, "x").real_time_factor == 2.0


def test_minimum_speed_above_the_maximum_is_refused() -> None:
    with pytest.raises(ParameterError, match="min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5"):
        from_dict(GotoParams, {"min_linear_velocity": 0.5}, "goto_as.yaml")


@pytest.mark.parametrize("frame", ["", "/map", "my map"])
@pytest.mark.parametrize("key", ["goal_frame", "default_frame"])
def test_frame_name_that_tf_rejects_is_refused_at_startup(key: str, frame: str) -> None:
    with pytest.raises(ParameterError, match=f"{key}: expected a frame name without blanks or a leading slash"):
        from_dict(BridgeParams, {key: frame}, "rviz_goto_ac.yaml")


def test_every_rate_parameter_is_passed_to_the_simulator() -> None:
    given = {
        "physics_rate": 600,
        "clock_rate": 1,
        "control_rate": 2,
        "scan_rate": 3,
        "odom_rate": 4,
        "joint_state_rate": 5,
        "imu_rate": 6,
        "ground_truth_rate": 8,
        "bumper_rate": 10,
        "battery_state_rate": 12,
        "magnetic_field_rate": 13,
        "camera_rate": 15,
    }
    rates = dataclasses.astuple(SimParams(**given).rates())  # type: ignore[arg-type]
    assert rates == tuple(given.values())


def test_limits_that_are_not_given_are_none() -> None:
    limits = SimParams().limits()
    assert limits.max_linear_velocity is None and limits.max_angular_acceleration is None
    assert SimParams(cmd_vel_timeout=0.0).limits().cmd_vel_timeout == 0.0
