"""Changing the server's parameters while it runs: which sets are valid, and what the tools show as bounds."""

from dataclasses import fields

import pytest
from aro_robocop_goto_as.cfg import GotoConfig

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.goto.params import GotoParams, differences, tuned

P = GotoParams()


def test_a_change_replaces_its_values_and_keeps_all_others():
    new = tuned(P, {"max_linear_velocity": 0.1, "angular_gain": 2.0})
    assert new == GotoParams(max_linear_velocity=0.1, angular_gain=2.0)
    assert differences(P, new) == ["angular_gain 2, was 5", "max_linear_velocity 0.1, was 0.2"]
    assert differences(P, tuned(P, {})) == []


@pytest.mark.parametrize(
    "changes, reason",
    [
        ({"min_linear_velocity": 0.5}, "min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5"),
        ({"max_angular_velocity": 0.1}, "min_angular_velocity: expected at most max_angular_velocity 0.1, got 0.3"),
    ],
)
def test_an_impossible_set_is_refused_with_the_reason(changes, reason):
    with pytest.raises(ParameterError) as refusal:
        tuned(P, changes)
    assert str(refusal.value) == f"changed parameters: {reason}"


def test_the_tools_show_the_defaults_and_bounds_of_the_parameters():
    specs = {spec.name: spec for spec in fields(GotoParams) if spec.metadata["live"]}
    assert {name: spec.default for name, spec in specs.items()} == GotoConfig.defaults
    assert {name: spec.metadata["low"] for name, spec in specs.items()} == GotoConfig.min
    assert {name: spec.metadata["high"] for name, spec in specs.items()} == GotoConfig.max
