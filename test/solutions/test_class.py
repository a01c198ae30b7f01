"""A class is graded whole on a scheduler's workers, one of them killed midway; interrupted, it goes on where it was.

Every hand-in is really judged, by a plan of one short scenario; `./robocop test --all` has 30 of them.
"""

import collections
import csv
import json
import os
import signal
import subprocess
import sys
import time

import distributed
import pytest
from graded import RIGHT, SWITCHES

PATIENCE = 60.0  # [s, wall]
PLAN = """
limits: {}
scenarios:
  - {name: near, about: A goal nearer than 0.1 m, script: [{goal: [0.03, 0.02], ends: SUCCEEDED}]}
checks:
  action_server: {part: server, points: 1, scenarios: [start]}
  already_there: {part: server, points: 1, scenarios: [near]}
"""


@pytest.fixture
def count(request):
    """How many hand in."""
    return 30 if request.config.getoption("--all") else 6


@pytest.fixture
def group(tmp_path, count):
    """The folder of a class: every third one's server never starts."""
    text = RIGHT["base_server"].read_text()
    folder = tmp_path / "class"
    folder.mkdir()
    (tmp_path / "plan.yaml").write_text(PLAN)
    for number in range(count):
        (folder / f"student_{number:02}.py").write_text(
            text.replace("self.server.start()", "pass") if number % 3 == 2 else text)
    return folder


@pytest.fixture
def start():
    """Start programs in sessions of their own; whatever is left of them is ended."""
    started = []

    def run(command, **more):
        started.append(subprocess.Popen(command, start_new_session=True, text=True, **more))
        return started[-1]

    yield run
    for process in started:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()


def grade_class(start, folder, *arguments):
    """`robocop grade-class`, with its output at hand."""
    command = ["rosrun", "aro_robocop_goto_as", "robocop_grade_class.py", str(folder), "--report",
               str(folder.parent / "results"), "--plan", str(folder.parent / "plan.yaml"), *SWITCHES, *arguments]
    return start(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def wait_for(condition, what):
    """Until a condition holds; what it returned."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"not within {PATIENCE:g} s: {what}")


def stamps(folder):
    """Name -> what each result was made from, and by whom, of all that are there."""
    return {path.parent.name: json.loads(path.read_text())
            for path in (folder.parent / "results").glob("student_*/hand_in.json")}


def rows(folder):
    """The table."""
    with open(folder.parent / "results" / "grades.csv", newline="") as text:
        return list(csv.DictReader(text))


def expect_everybody_once(folder, count, output):
    """Each hand-in is in the table, the overview and the output once, with the points it deserves."""
    names = [f"student_{number:02}.py" for number in range(count)]
    assert [row["name"] for row in rows(folder)] == names, output
    assert [row["points"] for row in rows(folder)] == ["0.0" if n % 3 == 2 else "2.0" for n in range(count)], output
    told = collections.Counter(line.split("] ")[1].split(":")[0] for line in output.splitlines() if line[:1] == "[")
    assert set(told.values()) == {1}, output
    html = (folder.parent / "results" / "index.html").read_text()
    assert f"{count} of {count} graded" in html and "refresh" not in html
    assert all(html.count(f"{name}/report.html") == 1 for name in names)


def test_a_killed_worker_loses_nothing_and_nobody_is_graded_twice(group, count, start, tmp_path):
    file = tmp_path / "scheduler.json"
    start([sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
           "--scheduler-file", str(file), "--no-dashboard"], stderr=subprocess.DEVNULL)
    address = wait_for(lambda: file.exists() and json.loads(file.read_text() or "{}").get("address"), "a scheduler")
    workers = {name: start([sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads",
                            "1", "--name", name, "--no-dashboard", "--memory-limit", "0", "--local-directory",
                            str(tmp_path)], stderr=subprocess.DEVNULL) for name in ("first", "second")}
    with distributed.Client(address, timeout=PATIENCE) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
        grading = grade_class(start, group, "--scheduler", address)

        def busy_worker():
            """A worker in the middle of a task, once some results are there."""
            known = {it["id"]: worker for worker, it in client.scheduler_info()["workers"].items()}
            processing = client.processing()
            busy = [name for name in workers if processing.get(known.get(name))]
            return busy if len(stamps(group)) >= count // 4 else None

        victim = workers[wait_for(busy_worker, "a busy worker and some results")[0]]
        os.kill(victim.pid, signal.SIGKILL)
    output, _ = grading.communicate(timeout=PATIENCE + 10.0 * count)
    assert grading.returncode == 0, output
    expect_everybody_once(group, count, output)
    assert len(stamps(group)) == count
    assert {it["worker"].split(":")[1] for it in stamps(group).values()} <= {str(it.pid) for it in workers.values()}


def test_interrupted_it_goes_on_where_it_was_and_does_nothing_twice(group, count, start, tmp_path, monkeypatch):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    first = grade_class(start, group)
    wait_for(lambda: len(stamps(group)) >= 1, "a first result")
    os.killpg(first.pid, signal.SIGINT)
    output, _ = first.communicate(timeout=PATIENCE)
    assert first.returncode == 130, output
    assert list(scratch.iterdir()) == []
    done = stamps(group)
    assert f"interrupted: {len(done)} of {count} graded; the same command goes on from there" in output
    assert 1 <= len(rows(group)) == len(done) < count
    places = {name: os.stat(group.parent / "results" / name).st_ino for name in done}

    second = grade_class(start, group)
    output, _ = second.communicate(timeout=PATIENCE + 10.0 * count)
    assert second.returncode == 0, output
    assert f"{count} handed in, {len(done)} of them graded already" in output
    expect_everybody_once(group, count, output)
    assert {name: os.stat(group.parent / "results" / name).st_ino for name in done} == places
    assert all(stamps(group)[name] == done[name] for name in done)


def test_without_a_scheduler_at_the_address_it_says_so(group, start):
    grading = grade_class(start, group, "--scheduler", "tcp://127.0.0.1:1")
    output, _ = grading.communicate(timeout=PATIENCE)
    assert grading.returncode == 1
    assert "no dask scheduler answers at tcp://127.0.0.1:1" in output
