"""Whom simulated time waits for."""

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.lockstep import Lockstep


def test_with_nobody_driving_it_waits_for_nobody() -> None:
    assert Lockstep().missing() == []


def test_who_commanded_once_is_waited_for_at_the_next_tick_and_not_at_this_one() -> None:
    lockstep = Lockstep()
    lockstep.commanded("/a")
    assert lockstep.missing() == []
    lockstep.tick += 1
    assert lockstep.missing() == ["/a"]
    lockstep.commanded("/a")
    assert lockstep.missing() == []


def test_who_stops_answering_costs_one_miss_and_is_waited_for_again_when_back() -> None:
    lockstep = Lockstep()
    lockstep.commanded("/a")
    lockstep.tick += 1
    assert lockstep.give_up() == ["/a"] and lockstep.misses == 1
    for _ in range(100):
        lockstep.tick += 1
        assert lockstep.missing() == []
    lockstep.commanded("/a")
    lockstep.tick += 1
    assert lockstep.missing() == ["/a"]


def test_a_slower_loop_is_waited_for_at_its_own_period_once_that_is_known() -> None:
    lockstep = Lockstep()
    given_up = []
    for tick in range(40):
        if tick % 3 == 0:
            lockstep.commanded("/slow")
        given_up += lockstep.give_up()
        lockstep.tick += 1
    assert given_up == ["/slow"]


def test_a_faster_loop_is_one_driver() -> None:
    lockstep = Lockstep()
    for _ in range(5):
        for _ in range(3):
            lockstep.commanded("/fast")
        assert lockstep.missing() == []
        lockstep.tick += 1
        assert lockstep.missing() == ["/fast"]


def test_a_stamped_answer_counts_for_its_own_tick_only() -> None:
    lockstep = Lockstep(7)
    lockstep.answered("/a", 6)
    assert lockstep.missing() == ["/a"]
    lockstep.answered("/a", 7)
    assert lockstep.missing() == []
    lockstep.answered("/a", 6)
    assert lockstep.missing() == []


def test_plain_commands_of_a_stamping_controller_are_no_answer() -> None:
    lockstep = Lockstep()
    lockstep.answered("/a", 0)
    lockstep.tick += 1
    lockstep.commanded("/a")
    assert lockstep.is_stamped("/a") and lockstep.missing() == ["/a"]


def test_who_disconnects_is_forgotten() -> None:
    lockstep = Lockstep()
    lockstep.answered("/a", 0)
    lockstep.tick += 1
    lockstep.gone("/a")
    assert lockstep.missing() == [] and lockstep.drivers() == []


@given(st.lists(st.sampled_from(["a", "b", "c", "pass", "stamp a"]), max_size=60))
def test_giving_up_always_frees_the_way(events: "list[str]") -> None:
    lockstep = Lockstep()
    for event in events:
        if event == "pass":
            lockstep.give_up()
            assert lockstep.missing() == []
            lockstep.tick += 1
        elif event == "stamp a":
            lockstep.answered("a", lockstep.tick)
        else:
            lockstep.commanded(event)
