"""The nodes' parameters: documented in the config files with their defaults, and consistent with each other."""

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
from aro_robocop_goto_as.simulation.params import SimParams

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
    specs = declared(cls)
    assert defaults.keys() == specs.keys()
    given = {key: value for key, value in defaults.items() if not str(value).startswith("<")}
    assert from_dict(cls, given, name) == cls()
    assert {key for key, (spec, _) in specs.items() if spec.default is None} == defaults.keys() - given.keys()


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


@pytest.mark.parametrize("key, cls", [("goal_frame", BridgeParams), ("map_frame", SimParams)])
def test_frame_name_that_tf_rejects_is_refused_at_startup(key: str, cls: Any) -> None:
    for frame in ("", "/map", "my map"):
        with pytest.raises(ParameterError, match=f"{key}: expected a frame name without blanks or a leading slash"):
            from_dict(cls, {key: frame}, "rviz_goto_ac.yaml")
