"""10,000 hand-ins pass through packing, scheduler, results, CSV and overview; a stub stands for the grading."""

import csv
import functools
import json
import os
import time

import psutil
import pytest
from graded import PLAN, RIGHT

from aro_robocop_goto_as.grading.classroom import dask_cluster
from aro_robocop_goto_as.grading.classroom.hand_ins import collect, pack
from aro_robocop_goto_as.grading.classroom.main import CSV, HTML, Class, grade
from aro_robocop_goto_as.grading.classroom.results import Results
from aro_robocop_goto_as.grading.classroom.worker import Done, Place, Task
from aro_robocop_goto_as.grading.plan import load

COUNT = 10_000
MOST_SECONDS = 0.02  # for each hand-in; of this process, whatever else the machine does
MOST_GROWTH = 10_000  # bytes of memory for each hand-in: its row with its causes and dask's log, not its report


@functools.lru_cache(maxsize=None)
def graded_report(right):
    """The checks of a report that is all right or all wrong; the cause lacks a figure."""
    failure = {"cause": "The robot stopped @ m away"}
    return json.dumps(
        [
            {
                "name": check.name,
                "part": check.part,
                "outcome": "passed" if right else "failed",
                "points": check.points if right else 0.0,
                "failure": None if right else failure,
            }
            for check in load(PLAN).checks
        ]
    )


def graded_at_once(task):
    """Stands for worker.work: every third hand-in fails each check, with a figure of its own."""
    number = int(task.hand_in.name[1:6])
    checks = graded_report(number % 3 != 0).replace("@", str(number / 1000))
    report = f'{{"name": "{task.hand_in.name}", "checks": {checks}, "problems": []}}'
    files = {"report.json": report.encode(), "report.html": b"<html>" * 5_000}
    return Done(task.hand_in.name, task.hand_in.digest, files, 0.0, "stub")


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_large_class_needs_little_time_for_each_hand_in_and_keeps_no_report_in_memory(tmp_path, monkeypatch):
    text = RIGHT["base_server"].read_text()
    (tmp_path / "class").mkdir()
    for number in range(COUNT):
        (tmp_path / "class" / f"s{number:05}.py").write_text(f"{text}# {number}")
    monkeypatch.setattr(dask_cluster, "work", graded_at_once)
    here, memory = psutil.Process(), []

    def tasks(waiting):
        for number, hand_in in enumerate(waiting):
            if number % (COUNT // 10) == 0:
                memory.append(here.memory_info().rss)
            yield Task(pack(hand_in.path), "", 0)

    started, busy = time.monotonic(), time.process_time()
    hand_ins, _ = collect(tmp_path / "class")
    group = Class(tmp_path / "class", Results(tmp_path / "results", {}), load(PLAN), hand_ins, again=False)
    grade(group, tasks(list(group.waiting.values())), Place(workers=len(os.sched_getaffinity(0))))
    wall, busy = time.monotonic() - started, time.process_time() - busy

    results = tmp_path / "results"
    with open(results / CSV, newline="", encoding="utf-8-sig") as table:
        assert len(list(csv.DictReader(table))) == COUNT
    assert f"{COUNT} of {COUNT} graded" in (results / HTML).read_text()
    memory.append(here.memory_info().rss)
    print(f"{1e3 * wall / COUNT:.1f} ms of wall time and {1e3 * busy / COUNT:.1f} ms of this process for each hand-in")
    print(f"memory by tenths of the class: {[number // 1024**2 for number in memory]} MB")
    print(f"{HTML}: {(results / HTML).stat().st_size / 1e6:.1f} MB")
    assert busy < MOST_SECONDS * COUNT
    assert memory[-2] - memory[1] < MOST_GROWTH * (COUNT - COUNT // 5)
