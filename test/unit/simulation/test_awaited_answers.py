"""Which controllers simulated time waits for."""

from fractions import Fraction

from hypothesis import example, given
from hypothesis import strategies as st

from aro_robocop_goto_as.simulation.awaited_answers import SURE, AwaitedAnswers


def test_without_controllers_nothing_is_awaited() -> None:
    assert AwaitedAnswers().missing() == []


def test_new_controller_is_awaited_from_the_tick_after_its_first_command() -> None:
    answers = AwaitedAnswers()
    answers.commanded("/a")
    assert answers.missing() == []
    answers.tick += 1
    assert answers.missing() == ["/a"]
    answers.commanded("/a")
    assert answers.missing() == []


def test_controller_that_stops_answering_causes_one_miss_and_is_awaited_again_when_it_returns() -> None:
    answers = AwaitedAnswers()
    for _ in range(2):
        answers.commanded("/a")
        answers.tick += 1
    assert answers.patience() == SURE
    assert answers.give_up() == ["/a"] and answers.misses == 1
    for _ in range(100):
        answers.tick += 1
        assert answers.missing() == []
    answers.commanded("/a")
    answers.tick += 1
    assert answers.missing() == ["/a"]


def test_controller_that_sends_a_single_command_causes_no_miss_and_little_waiting() -> None:
    answers = AwaitedAnswers()
    answers.commanded("/a")
    spent = 0.0
    for _ in range(100):
        answers.tick += 1
        spent += answers.patience()
        assert answers.give_up() == []
    assert spent < 1.5
    assert answers.awaited() == []


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
    answers, loop = AwaitedAnswers(), Loop(10 / hz, phase)
    misses, spent, waits = [], [], []
    for tick in range(1, 800):
        answers.tick = tick
        missing, patience = answers.missing(), answers.patience()
        if loop.due(tick):
            if missing:
                waits.append(patience)
            else:
                waits.append(0.0)
            answers.commanded("/a")
        elif missing:
            spent.append((tick, patience))
            misses += [tick for _ in answers.give_up()]
    assert len(misses) <= 1, "at most one, when the pattern looks simpler than it is"
    assert sum(patience for _, patience in spent) < 5.0
    assert max([tick for tick, _ in spent], default=0) < 500, "its pattern is still not known"
    assert set(waits[-5:]) == {SURE}


def test_loop_faster_than_the_ticks_is_awaited_once_per_tick() -> None:
    answers = AwaitedAnswers()
    for _ in range(5):
        for _ in range(3):
            answers.commanded("/fast")
        assert answers.missing() == []
        answers.tick += 1
        assert answers.missing() == ["/fast"]


def test_stamped_answer_counts_only_for_its_own_tick() -> None:
    answers = AwaitedAnswers(6)
    answers.enroll("/a")
    answers.tick = 7
    answers.answered("/a", 6)
    assert answers.missing() == ["/a"]
    answers.answered("/a", 7)
    assert answers.missing() == []
    answers.answered("/a", 6)
    assert answers.missing() == []


def test_answers_of_a_controller_that_is_not_enrolled_do_not_count_and_it_is_awaited_from_the_next_tick_on() -> None:
    answers = AwaitedAnswers(7)
    answers.answered("/a", 7)
    assert answers.awaited() == []
    answers.enroll("/a")
    assert answers.awaited() == ["/a"] and answers.missing() == []
    answers.tick = 8
    assert answers.missing() == ["/a"]


def test_plain_command_of_a_stamping_controller_is_not_an_answer() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    answers.tick += 1
    answers.commanded("/a")
    assert answers.is_stamped("/a") and answers.missing() == ["/a"]


def test_disconnected_controller_is_forgotten() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    answers.tick += 1
    answers.gone("/a")
    assert answers.missing() == [] and answers.awaited() == []


@given(st.lists(st.sampled_from(["a", "b", "c", "pass", "stamp a"]), max_size=60))
def test_giving_up_leaves_no_controller_missing(events: "list[str]") -> None:
    answers = AwaitedAnswers()
    for event in events:
        if event == "pass":
            answers.give_up()
            assert answers.missing() == []
            answers.tick += 1
        elif event == "stamp a":
            answers.enroll("a")
            answers.answered("a", answers.tick)
        else:
            answers.commanded(event)


def _answer_and_count_misses(answers: AwaitedAnswers, period: int, ticks: int) -> int:
    """A controller stamps answers to multiples of `period` only; how often it was waited for in vain."""
    misses = 0
    for _ in range(ticks):
        answers.tick += 1
        if answers.tick % period == 0:
            answers.answered("/a", answers.tick)
        misses += len(answers.give_up())
        assert answers.missing() == []
    return misses


def test_stamping_controller_slower_than_the_ticks_is_soon_awaited_at_its_own_ticks_only() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    assert 1 <= _answer_and_count_misses(answers, 3, 30) <= 5
    assert answers.take_slower() == [("/a", 3)] and answers.take_slower() == []
    assert _answer_and_count_misses(answers, 3, 300) == 0
    answers.tick += 3 - answers.tick % 3
    assert answers.missing() == ["/a"]


def test_stamping_controller_that_missed_ticks_is_awaited_at_each_one_again() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    for answers.tick in (2, 4, 8, 12):  # it hung in between
        answers.answered("/a", answers.tick)
    answers.tick = 13
    assert answers.missing() == []
    answers.answered("/a", 13)
    answers.tick = 14
    assert answers.missing() == ["/a"]


def test_stamping_controller_at_the_rate_of_the_ticks_is_never_called_slower() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    assert _answer_and_count_misses(answers, 1, 50) == 0 and answers.take_slower() == []


def test_period_is_learned_again_after_a_reset() -> None:
    answers = AwaitedAnswers()
    answers.enroll("/a")
    _answer_and_count_misses(answers, 2, 30)
    answers.restart(0)
    assert answers.missing() == ["/a"]
