"""The scheduler by itself, without threads: which thread it no longer waits for, and who gets the next turn."""

from robocop_grading.agent.scheduler import Scheduler, Waiter


def test_a_thread_is_no_longer_waited_for_only_if_no_other_runs_and_the_next_one_gets_its_turn():
    scheduler = Scheduler()
    scheduler.running = {1}
    assert scheduler.move_to_background({2}) is True  # another thread runs
    assert scheduler.background == set()
    assert scheduler.move_to_background({1}) is False  # nobody is next
    assert scheduler.background == {1}
    scheduler.queue.append(Waiter(3))
    assert scheduler.move_to_background({1}) is True
    assert scheduler.running == {1, 3} and not scheduler.queue


def test_all_threads_wait_when_none_runs_or_starts():
    scheduler = Scheduler()
    assert scheduler.wait_until_idle(0.0) is True
    scheduler.running = {1}
    assert scheduler.wait_until_idle(0.01) is False
    scheduler.running, scheduler.starting = set(), 1
    assert scheduler.wait_until_idle(0.01) is False and not scheduler.only_background_runs()


def test_no_other_thread_gets_a_turn_while_one_is_being_started():
    scheduler = Scheduler()
    starting, woken = scheduler.new_thread(), Waiter(3)
    with scheduler.guard:
        scheduler.wake(woken)
    assert list(scheduler.queue) == [woken] and scheduler.move_to_background(set())
    scheduler.cancel_start(starting)
    assert scheduler.running == {3} and not scheduler.starting
