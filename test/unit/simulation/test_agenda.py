"""When things are due: exactly as often as their rates say."""

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.simulation.agenda import due, due_next, stamp_ns


@given(st.integers(1, 240), st.integers(0, 10**6))
def test_rate_that_does_not_divide_the_physics_rate_has_an_exact_mean(rate, first):
    assert sum(due(step, rate, 240) for step in range(first + 1, first + 241)) == rate


@given(st.lists(st.integers(0, 240), max_size=5), st.sampled_from([1, 2, 10, 240]), st.integers(0, 1000))
def test_schedule_names_what_is_due_next_and_how_far_ahead_it_is(rates, exact, step):
    named = {f"sensor {i}": rate for i, rate in enumerate([*rates, exact])}
    steps, names = due_next(named, 240)[step % 240]
    assert names == tuple(name for name, rate in named.items() if rate and due(step + steps, rate, 240)) != ()
    assert not any(rate and due(step + early, rate, 240) for early in range(1, steps) for rate in named.values())


def test_stamps_do_not_drift():
    assert stamp_ns(1, 240) == 4166666 and stamp_ns(240 * 10**6, 240) == 10**15
