"""The nodes' parameters: documented in the config files, named and refused as ever, and consistent with each other."""

import json
import os
import re
from typing import Any, Dict

import pytest
import yaml
from support import ROOT

from aro_robocop_goto_as.bridge_params import BridgeParams
from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.param_loading import declared, from_dict
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.web_params import WebParams

BY_NAME: Dict[str, Any] = {cls.__name__: cls for cls in (SimParams, GotoParams, BridgeParams, WebParams)}
CONFIGS = [("sim.yaml", SimParams), ("goto_as.yaml", GotoParams), ("rviz_goto_ac.yaml", BridgeParams)]
with open(os.path.join(ROOT, "test", "unit", "data", "parameters_at_45233a1.json")) as recorded:
    RECORDED = json.load(recorded)
ADDED = {"WebParams": {"replay_waits"}}  # since they were recorded
REWORDED = (
    ("leave the key out for the model's own", "omit it to use the model's value"),
    ("leave the key out for the profile's own", "omit it to use the profile's value"),
)


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
    specs = declared(cls)
    assert defaults.keys() == specs.keys()
    given = {key: value for key, value in defaults.items() if not str(value).startswith("<")}
    assert from_dict(cls, given, name) == cls()
    assert {key for key, spec in specs.items() if spec.default is None} == defaults.keys() - given.keys()


@pytest.mark.parametrize("name", RECORDED["declared"])
def test_names_defaults_bounds_and_choices_are_those_that_were_recorded(name: str) -> None:
    found = {
        key: [str(spec.default), *(spec.metadata.get(what) for what in ("low", "high"))]
        + [list(spec.metadata.get("choices", ()))]
        for key, spec in declared(BY_NAME[name]).items()
        if key not in ADDED.get(name, ())
    }
    assert found == RECORDED["declared"][name]


@pytest.mark.parametrize("name", RECORDED["declared"])
def test_values_are_refused_in_the_words_that_were_recorded(name: str) -> None:
    found, expected = [], []
    for _, raw, text in (entry for entry in RECORDED["refused"] if entry[0] == name):
        for old, new in REWORDED:
            text = text.replace(old, new)
        expected.append((raw, text))
        with pytest.raises(ParameterError) as refusal:
            from_dict(BY_NAME[name], raw, "/robocop_sim")
        found.append((raw, str(refusal.value)))
    assert found == expected


def test_a_placeholder_for_a_default_is_refused_as_a_value() -> None:
    with pytest.raises(ParameterError, match="scan_rate: expected int, got str .*; omit it to use the profile's value"):
        from_dict(SimParams, {"scan_rate": documented("sim.yaml")["scan_rate"]}, "sim.yaml")


def test_rates_of_the_kinematic_configuration_are_consistent() -> None:
    with open(os.path.join(ROOT, "config", "kinematic.yaml")) as stream:
        raw = yaml.safe_load(stream)
    assert from_dict(SimParams, {**raw, "drive": "kinematic"}, "kinematic.yaml").rates.physics_rate == 30


@pytest.mark.parametrize(
    "raw, expected",
    [
        ({"imu_rate": 300}, "imu_rate: 300 Hz is above physics_rate 240 Hz"),
        ({"scan_rate": 7}, "scan_rate: 7 Hz does not divide physics_rate 240 Hz"),
        ({"scan_profile": "lds01", "physics_rate": 12}, "scan_rate: 5 Hz does not divide physics_rate 12 Hz"),
        ({"map_frame": "odom"}, "map_frame: expected six different frames, got 'odom' 2 times"),
        ({"camera_range_min": 20}, "camera_range_max: expected more than camera_range_min 20.0, got 10.0"),
        ({"scan_range_max": 0.1}, "scan_range_max: expected more than scan_range_min 0.12, got 0.1"),
        ({"scan_profile": "lds01", "scan_range_min": 4}, "expected more than scan_range_min 4.0, got 3.5"),
        ({"scan_angle_max": -1}, "scan_angle_max: expected more than scan_angle_min 0.0, got -1.0"),
    ],
)
def test_combinations_that_are_impossible_are_refused(raw: Dict[str, Any], expected: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        from_dict(SimParams, raw, "sim.yaml")
    assert str(refusal.value).startswith("sim.yaml: ") and expected in str(refusal.value)


def test_minimum_speed_above_the_maximum_is_refused() -> None:
    with pytest.raises(ParameterError, match="min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5"):
        from_dict(GotoParams, {"min_linear_velocity": 0.5}, "goto_as.yaml")


@pytest.mark.parametrize("frame", ["", "/map", "my map"])
@pytest.mark.parametrize(
    "key, cls", [("goal_frame", BridgeParams), ("default_frame", BridgeParams), ("map_frame", SimParams)]
)
def test_frame_name_that_tf_rejects_is_refused_at_startup(key: str, cls: Any, frame: str) -> None:
    with pytest.raises(ParameterError, match=f"{key}: expected a frame name without blanks or a leading slash"):
        from_dict(cls, {key: frame}, "rviz_goto_ac.yaml")


def test_limits_that_are_not_given_are_none() -> None:
    limits = SimParams().limits
    assert limits.max_linear_velocity is None and limits.max_angular_acceleration is None
    assert SimParams.of(cmd_vel_timeout=0.0).limits.cmd_vel_timeout == 0.0
