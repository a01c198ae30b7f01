"""10,000 hand-ins pass through packing, scheduler, results, CSV and overview; a stub stands for the grading."""

import csv
import os
import time

import psutil
import pytest
from graded import PLAN, RIGHT
from stub_worker import graded_at_once

from robocop_grading.classroom import dask_cluster
from robocop_grading.classroom.hand_ins import collect, pack
from robocop_grading.classroom.main import CSV, HTML, Class, grade
from robocop_grading.classroom.results import Results
from robocop_grading.classroom.worker import Place, Task
from robocop_grading.plan import load

COUNT = 10_000
MOST_SECONDS = 0.02  # for each hand-in; of this process, whatever else the machine does
MOST_GROWTH = 10_000  # bytes of memory for each hand-in: its row with its causes and dask's log, not its report


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_large_class_needs_little_time_for_each_hand_in_and_keeps_no_report_in_memory(tmp_path, monkeypatch):
    text = RIGHT["base_server"].read_text()
    (tmp_path / "class").mkdir()
    for number in range(COUNT):
        (tmp_path / "class" / f"s{number:05}.py").write_text(f"{text}# {number}")
    monkeypatch.setattr(dask_cluster, "work", graded_at_once)
    here, memory, plan = psutil.Process(), [], load(PLAN)

    def tasks(waiting):
        for number, hand_in in enumerate(waiting):
            if number % (COUNT // 10) == 0:
                memory.append(here.memory_info().rss)
            yield Task(pack(hand_in.path), plan)

    started, busy = time.monotonic(), time.process_time()
    hand_ins, _ = collect(tmp_path / "class")
    group = Class(tmp_path / "class", Results(tmp_path / "results", {}), plan, hand_ins, again=())
    grade(group, tasks(list(group.waiting.values())), Place(workers=len(os.sched_getaffinity(0))))
    wall, busy = time.monotonic() - started, time.process_time() - busy

    results = tmp_path / "results"
    with open(results / CSV, newline="", encoding="utf-8-sig") as table:
        assert len(list(csv.DictReader(table))) == COUNT
    assert f"{COUNT} judged, 0 not gradable" in (results / HTML).read_text()
    memory.append(here.memory_info().rss)
    print(f"{1e3 * wall / COUNT:.1f} ms of wall time and {1e3 * busy / COUNT:.1f} ms of this process for each hand-in")
    print(f"memory by tenths of the class: {[number // 1024**2 for number in memory]} MB")
    print(f"{HTML}: {(results / HTML).stat().st_size / 1e6:.1f} MB")
    assert busy < MOST_SECONDS * COUNT
    assert memory[-2] - memory[1] < MOST_GROWTH * (COUNT - COUNT // 5)
