"""How many hand-ins are graded at once: fewer where they take long, and those without time come last, alone."""

import math

import pytest
from class_records import PLAN

from aro_robocop_goto_as.errors import NoTimeError
from robocop_grading.classroom import dask_cluster
from robocop_grading.classroom.dask_cluster import SLOW, Pace, grade_all
from robocop_grading.classroom.hand_ins import HandIn
from robocop_grading.classroom.worker import Done, Task


@pytest.mark.parametrize(
    "taken, at_once",
    [
        ([], 4),
        ([10.0, 20.0], 4),
        ([2 * SLOW], 3),
        ([2 * SLOW] * 9, 1),
        ([math.inf], 2),
        ([math.inf, math.inf, math.inf], 1),
        ([math.inf, 10.0], 3),
    ],
)
def test_fewer_are_graded_at_once_where_the_machine_is_slow(taken, at_once):
    pace, fixed = Pace(4, False), Pace(4, True)
    for seconds in taken:
        pace.note(seconds)
        fixed.note(seconds)
    assert (pace.at_once, fixed.at_once) == (at_once, 4)


class Graded:
    """A future that is finished, and a client that grades in this process."""

    status = "finished"

    def __init__(self, result):
        self.result = lambda: result

    def done(self):
        return True


class Here:
    """The part of dask's client and of as_completed that grade_all uses."""

    def __init__(self, grade):
        self.grade, self.futures, self.most = grade, [], 0

    def submit(self, _work, task, **_):
        future = Graded(self.grade(task))
        return future

    def add(self, future):
        self.futures.append(future)
        self.most = max(self.most, len(self.futures))

    def __iter__(self):
        while self.futures:
            yield self.futures.pop(0)

    def cancel(self, futures):
        assert futures == []


def test_hand_in_without_time_is_graded_again_at_the_end_and_has_no_grade_if_it_fails_again(monkeypatch):
    tried = []

    def grade(task):
        tried.append(task.hand_in.name)
        slow = task.hand_in.name == "ben" or (task.hand_in.name == "anna" and tried.count("anna") == 1)
        return NoTimeError("the machine is busy") if slow else Done(task.hand_in.name, "", seconds=1.0)

    here = Here(grade)
    monkeypatch.setattr(dask_cluster, "as_completed", lambda: here)
    monkeypatch.setattr(dask_cluster, "wait", lambda _: None)
    tasks = [Task(HandIn(name), PLAN) for name in ("anna", "ben", "carl", "dora")]
    found = dict(grade_all(here, tasks, Pace(2, False)))
    assert found["ben"] == "no grade: the machine is busy"
    assert all(isinstance(found[name], Done) for name in ("anna", "carl", "dora"))
    assert tried == ["anna", "ben", "carl", "dora", "anna", "ben"] and here.most <= 2
