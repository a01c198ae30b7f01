"""Whom simulated time waits for."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.lockstep import SURE, Lockstep


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
    for _ in range(2):
        lockstep.commanded("/a")
        lockstep.tick += 1
    assert lockstep.patience() == SURE
    assert lockstep.give_up() == ["/a"] and lockstep.misses == 1
    for _ in range(100):
        lockstep.tick += 1
        assert lockstep.missing() == []
    lockstep.commanded("/a")
    lockstep.tick += 1
    assert lockstep.missing() == ["/a"]


def test_who_commands_just_once_costs_no_miss_and_little_time() -> None:
    lockstep = Lockstep()
    lockstep.commanded("/a")
    spent = 0.0
    for _ in range(100):
        lockstep.tick += 1
        spent += lockstep.patience()
        assert lockstep.give_up() == []
    assert spent < 1.5
    assert lockstep.drivers() == []


class Loop:
    """rospy's Rate on simulated time, from a phase on: at which ticks its command comes."""

    def __init__(self, period: Fraction, phase: Fraction) -> None:
        self.period, self.next = period, phase

    def due(self, tick: int) -> bool:
        """Whether it wakes up after the tick before and not after this one."""
        if self.next > tick:
            return False
        self.next += self.period
        return True


@given(st.sampled_from([Fraction(hz) for hz in ("10", "8", "7", "5", "4", "3", "5/2", "2", "1", "4/5", "2/3")]),
       st.fractions(0, 1, max_denominator=60))
def test_a_loop_of_any_rate_is_waited_for_when_it_is_due_and_only_then(hz: Fraction, phase: Fraction) -> None:
    lockstep, loop = Lockstep(), Loop(10 / hz, phase)
    misses, spent, answers = [], [], []
    for tick in range(1, 800):
        lockstep.tick = tick
        missing, patience = lockstep.missing(), lockstep.patience()
        if loop.due(tick):
            if missing:
                answers.append(patience)
            else:
                answers.append(0.0)
            lockstep.commanded("/a")
        elif missing:
            spent.append((tick, patience))
            misses += [tick for _ in lockstep.give_up()]
    assert len(misses) <= 1, "once, when a rhythm looked simpler than it is"
    assert sum(patience for _, patience in spent) < 5.0
    assert max([tick for tick, _ in spent], default=0) < 500, "it is still not known"
    assert set(answers[-5:]) == {SURE}


def test_a_steady_loop_is_known_to_be_slower_than_the_ticks_or_not() -> None:
    for every in (1, 3):
        lockstep = Lockstep()
        for tick in range(1, 30):
            lockstep.tick = tick
            if tick % every == 0:
                lockstep.commanded("/a")
        assert lockstep.slower_than_ticks() == (every == 3)
    assert not Lockstep().slower_than_ticks()


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
