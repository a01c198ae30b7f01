"""Which key of a terminal counts as held."""

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.ros.cli.held_key import FIRST_REPEAT, NEXT_REPEAT, HeldKey

REPEAT_DELAYS = st.floats(0.2, 0.7)  # [s] until a held key repeats first
REPEAT_PERIODS = st.floats(0.01, 0.2)  # [s]


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


def test_another_key_replaces_the_held_one_and_none_is_held_after_release():
    keys = HeldKey()
    keys.press("w", 0.0)
    keys.press("a", 0.1)
    assert keys.at(0.1) == "a"
    keys.release()
    assert keys.at(0.1) == ""
