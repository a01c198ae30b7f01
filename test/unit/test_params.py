"""Parameters are taken as they are or refused by name; the config files document all of them."""

import dataclasses
import math
import os
from typing import Any, Dict

import pytest
import yaml
from support import ROOT

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.params import BridgeParams, GotoParams, SimParams, from_dict

CONFIGS = [("sim.yaml", SimParams), ("goto_as.yaml", GotoParams), ("rviz_goto_ac.yaml", BridgeParams)]


@pytest.mark.parametrize("name, cls", CONFIGS)
def test_a_config_file_holds_every_parameter_with_its_default(name: str, cls: Any) -> None:
    with open(os.path.join(ROOT, "config", name)) as stream:
        raw = yaml.safe_load(stream)
    assert set(raw) == {field.name for field in dataclasses.fields(cls)}
    assert from_dict(cls, raw, name) == cls()


def test_the_kinematic_drives_rates_fit_each_other() -> None:
    with open(os.path.join(ROOT, "config", "kinematic.yaml")) as stream:
        raw = yaml.safe_load(stream)
    assert from_dict(SimParams, {**raw, "drive": "kinematic"}, "kinematic.yaml").physics_rate == 30


@pytest.mark.parametrize("name, cls", CONFIGS)
def test_every_key_of_a_config_file_is_explained(name: str, cls: Any) -> None:
    with open(os.path.join(ROOT, "config", name)) as stream:
        keys = [line for line in stream if line[0].isalpha()]
    bare = [line for line in keys if "#" not in line]
    assert bare == ["scan_frame: base_scan\n", "imu_frame: imu_link\n"] or bare == []


@pytest.mark.parametrize("raw, expected", [
    ({"wrold": "stage_1"}, "wrold: unknown parameter; did you mean 'world'?"),
    ({"zzz": 1}, "zzz: unknown parameter; known are: accelerometer_noise, "),
    ({"scan_rate": "10"}, "scan_rate: expected int, got str '10'"),
    ({"scan_rate": 10.0}, "scan_rate: expected int, got float 10.0"),
    ({"gui": 1}, "gui: expected bool, got int 1"),
    ({"seed": True}, "seed: expected int, got bool True"),
    ({"cmd_vel_timeout": -2.0}, "cmd_vel_timeout: expected at least -1, got -2.0"),
    ({"cmd_vel_timeout": -0.5}, "cmd_vel_timeout: expected at least 0, or -1 for the model's own, got -0.5"),
    ({"magnetic_field_rate": 300}, "magnetic_field_rate: 300 Hz is above physics_rate 240 Hz"),
    ({"scan_noise": math.nan}, "scan_noise: expected a finite number, got nan"),
    ({"localization": "gps"}, "localization: expected one of static, truth, got 'gps'"),
    ({"scan_rate": 7}, "scan_rate: 7 Hz does not divide physics_rate 240 Hz"),
    ({"imu_rate": 300}, "imu_rate: 300 Hz is above physics_rate 240 Hz"),
    ({"scan_range_max": 0.1}, "scan_range_max: expected more than scan_range_min 0.12, got 0.1"),
    ({"solver_iterations": 10**9}, "solver_iterations: expected at most 10000, got 1000000000"),
    ({"max_linear_velocity": 1e300}, "max_linear_velocity: expected at most 1e+06, got 1e+300"),
    ({"odom_frame": "/odom"}, "odom_frame: expected a frame's name without blank or leading slash, got '/odom'"),
    ({"map_frame": ""}, "map_frame: expected a frame's name without blank or leading slash, got ''"),
    ({"map_frame": "odom"}, "map_frame: expected six different frames, got 'odom' 2 times"),
    ({"camera_range_min": 20}, "camera_range_max: expected more than camera_range_min 20.0, got 10.0"),
    ({"scan_profile": "lds03"}, "scan_profile: expected one of gazebo, ideal, lds01, lds02, got 'lds03'"),
    ({"scan_profile": "lds01", "scan_range_min": 4}, "scan_range_max: expected more than scan_range_min 4.0, got 3.5"),
    ({"scan_profile": "lds01", "physics_rate": 12}, "scan_rate: 5 Hz does not divide physics_rate 12 Hz"),
    ({"scan_samples": 1}, "scan_samples: expected at least 2, or 0 for the profile's own, got 1"),
    ({"scan_noise": -0.5}, "scan_noise: expected at least 0, or -1 for the profile's own, got -0.5"),
    ({"scan_angle_max": -1}, "scan_angle_max: expected more than scan_angle_min 0.0, got -1.0"),
])
def test_a_wrong_parameter_is_refused_with_source_key_value_and_expectation(raw: Dict[str, Any], expected: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        from_dict(SimParams, raw, "sim.yaml")
    assert str(refusal.value).startswith("sim.yaml: ")
    assert expected in str(refusal.value)


def test_all_wrong_parameters_are_named_at_once() -> None:
    with pytest.raises(ParameterError, match="(?s)scan_rate.*seed"):
        from_dict(SimParams, {"scan_rate": -1, "seed": -1}, "sim.yaml")


def test_a_whole_number_serves_where_a_real_one_is_asked_for() -> None:
    assert from_dict(SimParams, {"real_time_factor": 2}, "x").real_time_factor == 2.0


def test_speeds_whose_minimum_is_above_the_maximum_are_refused() -> None:
    with pytest.raises(ParameterError, match="min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5"):
        from_dict(GotoParams, {"min_linear_velocity": 0.5}, "goto_as.yaml")


@pytest.mark.parametrize("frame", ["", "/map", "my map"])
@pytest.mark.parametrize("key", ["goal_frame", "default_frame"])
def test_a_frame_that_tf_would_refuse_is_refused_at_the_start(key: str, frame: str) -> None:
    with pytest.raises(ParameterError, match=f"{key}: expected a frame's name without blank or leading slash"):
        from_dict(BridgeParams, {key: frame}, "rviz_goto_ac.yaml")
