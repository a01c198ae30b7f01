"""Which controllers simulated time waits for."""

from fractions import Fraction

from hypothesis import example, given
from hypothesis import strategies as st

from aro_robocop_goto_as.simulation.lockstep import SURE, Lockstep


def test_without_controllers_nothing_is_awaited() -> None:
    assert Lockstep().missing() == []


def test_new_controller_is_awaited_from_the_tick_after_its_first_command() -> None:
    lockstep = Lockstep()
    lockstep.commanded("/a")
    assert lockstep.missing() == []
    lockstep.tick += 1
    assert lockstep.missing() == ["/a"]
    lockstep.commanded("/a")
    assert lockstep.missing() == []


def test_controller_that_stops_answering_causes_one_miss_and_is_awaited_again_when_it_returns() -> None:
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


def test_controller_that_sends_a_single_command_causes_no_miss_and_little_waiting() -> None:
    lockstep = Lockstep()
    lockstep.commanded("/a")
    spent = 0.0
    for _ in range(100):
        lockstep.tick += 1
        spent += lockstep.patience()
        assert lockstep.give_up() == []
    assert spent < 1.5
    assert lockstep.awaited() == []


class Loop:
    """A loop with rospy.Rate in simulated time, starting at a phase; tells at which ticks its command arrives."""

    def __init__(self, period: Fraction, phase: Fraction) -> None:
        self.period, self.next = period, phase

    def due(self, tick: int) -> bool:
        """Whether it wakes up after the previous tick and no later than this one."""
        if self.next > tick:
            return False
        self.next += self.period
        return True


@given(
    st.sampled_from([Fraction(hz) for hz in ("10", "9", "8", "7", "6", "5", "4", "3", "5/2", "2", "1", "4/5", "2/3")]),
    st.fractions(0, 1, max_denominator=60),
)
@example(Fraction(7), Fraction(0))
def test_loop_of_any_rate_is_soon_awaited_exactly_when_it_is_due(hz: Fraction, phase: Fraction) -> None:
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
    assert len(misses) <= 1, "at most one, when the pattern looks simpler than it is"
    assert sum(patience for _, patience in spent) < 5.0
    assert max([tick for tick, _ in spent], default=0) < 500, "its pattern is still not known"
    assert set(answers[-5:]) == {SURE}


def test_loop_faster_than_the_ticks_is_awaited_once_per_tick() -> None:
    lockstep = Lockstep()
    for _ in range(5):
        for _ in range(3):
            lockstep.commanded("/fast")
        assert lockstep.missing() == []
        lockstep.tick += 1
        assert lockstep.missing() == ["/fast"]


def test_stamped_answer_counts_only_for_its_own_tick() -> None:
    lockstep = Lockstep(6)
    lockstep.enroll("/a")
    lockstep.tick = 7
    lockstep.answered("/a", 6)
    assert lockstep.missing() == ["/a"]
    lockstep.answered("/a", 7)
    assert lockstep.missing() == []
    lockstep.answered("/a", 6)
    assert lockstep.missing() == []


def test_answers_of_a_controller_that_is_not_enrolled_do_not_count_and_it_is_awaited_from_the_next_tick_on() -> None:
    lockstep = Lockstep(7)
    lockstep.answered("/a", 7)
    assert lockstep.awaited() == []
    lockstep.enroll("/a")
    assert lockstep.awaited() == ["/a"] and lockstep.missing() == []
    lockstep.tick = 8
    assert lockstep.missing() == ["/a"]


def test_plain_command_of_a_stamping_controller_is_not_an_answer() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    lockstep.tick += 1
    lockstep.commanded("/a")
    assert lockstep.is_stamped("/a") and lockstep.missing() == ["/a"]


def test_disconnected_controller_is_forgotten() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    lockstep.tick += 1
    lockstep.gone("/a")
    assert lockstep.missing() == [] and lockstep.awaited() == []


@given(st.lists(st.sampled_from(["a", "b", "c", "pass", "stamp a"]), max_size=60))
def test_giving_up_leaves_no_controller_missing(events: "list[str]") -> None:
    lockstep = Lockstep()
    for event in events:
        if event == "pass":
            lockstep.give_up()
            assert lockstep.missing() == []
            lockstep.tick += 1
        elif event == "stamp a":
            lockstep.enroll("a")
            lockstep.answered("a", lockstep.tick)
        else:
            lockstep.commanded(event)


def _answer_and_count_misses(lockstep: Lockstep, period: int, ticks: int) -> int:
    """A controller stamps answers to multiples of `period` only; how often it was waited for in vain."""
    misses = 0
    for _ in range(ticks):
        lockstep.tick += 1
        if lockstep.tick % period == 0:
            lockstep.answered("/a", lockstep.tick)
        misses += len(lockstep.give_up())
        assert lockstep.missing() == []
    return misses


def test_stamping_controller_slower_than_the_ticks_is_soon_awaited_at_its_own_ticks_only() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    assert 1 <= _answer_and_count_misses(lockstep, 3, 30) <= 5
    assert lockstep.take_slower() == [("/a", 3)] and lockstep.take_slower() == []
    assert _answer_and_count_misses(lockstep, 3, 300) == 0
    lockstep.tick += 3 - lockstep.tick % 3
    assert lockstep.missing() == ["/a"]


def test_stamping_controller_that_missed_ticks_is_awaited_at_each_one_again() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    for lockstep.tick in (2, 4, 8, 12):  # it hung in between
        lockstep.answered("/a", lockstep.tick)
    lockstep.tick = 13
    assert lockstep.missing() == []
    lockstep.answered("/a", 13)
    lockstep.tick = 14
    assert lockstep.missing() == ["/a"]


def test_stamping_controller_at_the_rate_of_the_ticks_is_never_called_slower() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    assert _answer_and_count_misses(lockstep, 1, 50) == 0 and lockstep.take_slower() == []


def test_period_is_learned_again_after_a_reset() -> None:
    lockstep = Lockstep()
    lockstep.enroll("/a")
    _answer_and_count_misses(lockstep, 2, 30)
    lockstep.restart(0)
    assert lockstep.missing() == ["/a"]
