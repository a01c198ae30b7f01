"""The nodes' parameters: documented in the config files with their defaults, and consistent with each other."""

import os
import re

import pytest
import yaml
from param_docs import CHECKOUT, NODES, documents
from support import ROOT

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.param_loading import declared, from_dict
from aro_robocop_goto_as.ros.client.params import BridgeParams
from aro_robocop_goto_as.simulation.params import SimParams


@pytest.mark.parametrize("path", documents(), ids=lambda path: path.name)
def test_what_documents_the_parameters_is_up_to_date(path):
    assert path.read_text() == documents()[path], "run ./robocop shell python3 test/unit/param_docs.py"


@pytest.mark.parametrize("node", NODES, ids=lambda node: node.node)
def test_every_parameter_has_a_meaning(node):
    assert [name for name, (spec, _) in declared(node.params).items() if not spec.metadata.get("about")] == []


@pytest.mark.parametrize("node", [node for node in NODES if node.yaml], ids=lambda node: node.node)
def test_a_config_file_sets_nothing_and_shows_the_defaults_with_which_the_node_starts(node):
    text = (CHECKOUT / node.yaml).read_text()
    assert yaml.safe_load(text) is None
    shown = yaml.safe_load("\n".join(re.findall(r"^#(\w+: .*)", text, re.MULTILINE)))
    given = {key: value for key, value in shown.items() if not str(value).startswith("<")}
    assert shown.keys() == declared(node.params).keys()
    assert from_dict(node.params, given, node.yaml) == node.params()


def test_rates_of_the_kinematic_configuration_are_consistent():
    with open(os.path.join(ROOT, "config", "kinematic.yaml")) as stream:
        raw = yaml.safe_load(stream)
    assert from_dict(SimParams, {**raw, "drive": "kinematic"}, "kinematic.yaml").rates.physics_rate == 30


@pytest.mark.parametrize(
    "raw, expected",
    [
        ({"imu_rate": 300}, "imu_rate: 300 Hz is above physics_rate 240 Hz"),
        ({"scan_rate": 7}, "scan_rate: 7 Hz does not divide physics_rate 240 Hz"),
        ({"scan_profile": "lds01", "physics_rate": 12}, "scan_rate: 5 Hz does not divide physics_rate 12 Hz"),
        ({"camera_range_min": 20}, "camera_range_max: expected more than camera_range_min 20.0, got 10.0"),
        ({"scan_range_max": 0.1}, "scan_range_max: expected more than scan_range_min 0.12, got 0.1"),
        ({"scan_profile": "lds01", "scan_range_min": 4}, "expected more than scan_range_min 4.0, got 3.5"),
        ({"scan_angle_max": -1}, "scan_angle_max: expected more than scan_angle_min 0.0, got -1.0"),
    ],
)
def test_combinations_that_are_impossible_are_refused(raw, expected):
    with pytest.raises(ParameterError) as refusal:
        from_dict(SimParams, raw, "sim.yaml")
    assert str(refusal.value).startswith("sim.yaml: ") and expected in str(refusal.value)


def test_frame_name_that_tf_rejects_is_refused_at_startup():
    for frame in ("", "/map", "my map"):
        with pytest.raises(ParameterError, match="goal_frame: expected a frame name without blanks or a leading slash"):
            from_dict(BridgeParams, {"goal_frame": frame}, "rviz_goto_ac.yaml")
