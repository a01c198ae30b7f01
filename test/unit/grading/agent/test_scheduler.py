"""The scheduler by itself, without threads: which thread it no longer waits for, and who gets the next turn."""

from robocop_grading.agent.scheduler import Scheduler, Waiter


def test_a_thread_is_no_longer_waited_for_only_if_no_other_runs_and_the_next_one_gets_its_turn():
    scheduler = Scheduler()
    scheduler.running = {1}
    assert scheduler.wait_for_none_of({2}) is True  # another thread runs
    assert scheduler.unawaited == set()
    assert scheduler.wait_for_none_of({1}) is False  # nobody is next
    assert scheduler.unawaited == {1}
    scheduler.queue.append(Waiter(3))
    assert scheduler.wait_for_none_of({1}) is True
    assert scheduler.running == {1, 3} and not scheduler.queue
