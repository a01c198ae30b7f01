"""Teleoperation: the keys in what a terminal sends, and the velocities they stand for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.ros.cli.teleop import KEYS, command, keys_of


@given(st.lists(st.sampled_from([*KEYS, " ", "\x1b[A", "\x1bOC", "\x1b[Z", "ü"])))
def test_keys_are_separated_in_what_a_terminal_sends(pressed):
    assert keys_of("".join(pressed)) == pressed


@pytest.mark.parametrize(
    "key, twist",
    [
        ("w", Twist2D(0.1, 0.0)),
        ("\x1b[D", Twist2D(0.0, 2.0)),
        ("\x1bOB", Twist2D(-0.1, 0.0)),
        ("e", Twist2D(0.1, -2.0)),
        (" ", STANDSTILL),
    ],
)
def test_key_stands_for_a_velocity_and_every_other_key_for_standstill(key, twist):
    assert command(key, 0.1, 2.0) == twist
