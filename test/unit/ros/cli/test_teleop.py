"""Teleoperation: the keys in what a terminal sends, which of them counts as held, and the velocities they stand for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.ros.cli.teleop import FIRST_REPEAT, KEYS, NEXT_REPEAT, HeldKey, command, keys_of

REPEAT_DELAYS = st.floats(0.2, 0.7)  # [s] until a held key repeats first
REPEAT_PERIODS = st.floats(0.01, 0.2)  # [s]


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


@given(REPEAT_DELAYS, REPEAT_PERIODS, st.integers(1, 50))
def test_key_counts_as_held_from_its_press_to_its_last_repetition(delay, period, count):
    keys, now = HeldKey(), 0.0
    keys.press("w", now)
    for number in range(count):
        step = period if number else delay
        assert keys.at(now + 0.99 * step) == "w"
        now += step
        keys.press("w", now)
    assert keys.at(now + NEXT_REPEAT) == ""


def test_tapped_key_is_released_when_it_does_not_repeat():
    keys = HeldKey()
    assert keys.at(0.0) == ""
    keys.press("w", 1.0)
    assert keys.at(1.0 + FIRST_REPEAT) == ""


def test_another_key_replaces_the_held_one():
    keys = HeldKey()
    keys.press("w", 0.0)
    keys.press("a", 0.1)
    assert keys.at(0.1) == "a"
