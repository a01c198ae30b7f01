"""What other threads ask of the owner of a simulation."""

import threading

import pytest

from aro_robocop_goto_as.errors import ShutdownError, WorldError
from aro_robocop_goto_as.simulation.jobs import Jobs, WallClock


def test_call_from_another_thread_returns_the_jobs_result_or_raises_its_error():
    done = threading.Event()
    jobs = Jobs(WallClock(), done.is_set)
    outcomes = []

    def refuse():
        raise WorldError("no such model")

    def caller():
        outcomes.append(jobs.call(threading.get_ident))
        with pytest.raises(WorldError, match="no such model"):
            jobs.call(refuse)
        outcomes.append("raised")
        done.set()

    thread = threading.Thread(target=caller)
    thread.start()
    while not done.is_set():
        jobs.run_next(0.1)
    thread.join(10.0)
    assert outcomes == [threading.get_ident(), "raised"]
    with pytest.raises(ShutdownError):
        jobs.call(lambda: None)


def test_queued_jobs_are_run_and_those_that_they_post_are_left_for_later():
    jobs, ran = Jobs(WallClock(), lambda: False), []
    jobs.post(lambda: jobs.post(lambda: ran.append("later")))
    jobs.post(lambda: ran.append("queued"))
    jobs.run_queued()
    assert (ran, len(jobs)) == (["queued"], 1)
