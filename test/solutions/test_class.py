"""A class is graded completely although a worker is killed; an interrupted run can be continued.

Every hand-in is graded with a plan of one short scenario.
"""

import collections
import csv
import json
import os
import signal
import subprocess
import sys

import pytest
from documentation import ROOT
from processes import busy_processes, processes_mentioning
from right_solutions import RIGHT
from waiting import wait_for

from robocop_grading.classroom.cluster import connected

TIMEOUT = 120.0  # [s, wall]
PLAN = """
limits: {}
checks:
  action_server: {points: 1}
  already_there: {points: 1}
"""


@pytest.fixture
def group(tmp_path, request):
    """The folder of a class of three, or of as many as a test asks for; every third server never starts."""
    text = RIGHT["base_server"]
    folder = tmp_path / "class"
    folder.mkdir()
    (tmp_path / "plan.yaml").write_text(PLAN)
    for number in range(getattr(request, "param", 3)):
        (folder / f"student_{number:02}.py").write_text(
            text.replace("self.server.start()", "pass") if number % 3 == 2 else text
        )
    return folder


@pytest.fixture
def key_of_cluster(tmp_path, monkeypatch):
    """A key and dask's configuration with it, made as docs/grading.md says."""
    text = (ROOT / "docs" / "grading.md").read_text(encoding="utf-8")
    commands = text[text.index("openssl req") : text.index("export DASK_CONFIG")]
    subprocess.run(commands, shell=True, cwd=tmp_path, check=True, capture_output=True)
    monkeypatch.setenv("DASK_CONFIG", str(tmp_path / "dask.yaml"))


@pytest.fixture
def start():
    """Start programs in new sessions and kill what is left of them at the end."""
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
    """Start `robocop grade-class` with its output in a pipe."""
    command = [
        "rosrun",
        "aro_robocop_goto_as",
        "robocop_grade_class.py",
        str(folder),
        "--report",
        str(folder.parent / "results"),
        "--plan",
        str(folder.parent / "plan.yaml"),
        *arguments,
    ]
    return start(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def stamps(folder):
    """Name -> the stamp of each result that exists."""
    return {
        path.parent.name: json.loads(path.read_text())
        for path in (folder.parent / "results").glob("student_*/hand_in.json")
    }


def rows(folder):
    """The rows of the CSV table."""
    with open(folder.parent / "results" / "grades.csv", newline="", encoding="utf-8-sig") as text:
        return list(csv.DictReader(text))


def expect_everybody_once(folder, output, not_gradable):
    """Each hand-in is in the table, the overview and the output once, with its points or (`not_gradable`) a reason."""
    judged, table = [path.name for path in sorted(folder.glob("*.py"))], {row["name"]: row for row in rows(folder)}
    assert sorted(table) == sorted([*judged, *not_gradable]) and len(rows(folder)) == len(table), output
    points = ["0.0" if number % 3 == 2 else "2.0" for number in range(len(judged))]
    assert [table[name]["points"] for name in judged] == points, output
    for name, reason in not_gradable.items():
        assert not table[name]["points"] and table[name]["problem"].startswith(reason), table[name]
        assert f"not gradable: {name}: {reason}" in output
    printed = collections.Counter(line.split("] ")[1].split(":")[0] for line in output.splitlines() if line[:1] == "[")
    assert set(printed.values()) == {1}, output
    html = (folder.parent / "results" / "index.html").read_text()
    assert f"{len(judged)} judged, {len(not_gradable)} not gradable" in html
    assert all(html.count(f"{name}/report.html") == 1 for name in judged)


@pytest.mark.slow
@pytest.mark.timeout(900)  # one worker is left for most of them
@pytest.mark.parametrize("group", [5], indirect=True)
def test_when_a_worker_is_killed_every_hand_in_is_still_graded_exactly_once(group, start, key_of_cluster):
    dask, log = [sys.executable, "-m"], group.parent / "log"
    own = ["--host", "127.0.0.1", "--port", "0", "--protocol", "tls", "--no-dashboard", "--scheduler-file", log]
    start([*dask, "distributed.cli.dask_scheduler", *own], stderr=subprocess.DEVNULL)
    address = wait_for(lambda: log.exists() and json.loads(log.read_text() or "{}").get("address"), "a scheduler")
    command = [*dask, "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    worker, _ = (start(command, cwd=group.parent, stderr=subprocess.DEVNULL) for _ in range(2))
    grading = grade_class(start, group, "--scheduler", address)
    wait_for(lambda: len(stamps(group)) >= 2, "some results")
    os.kill(worker.pid, signal.SIGKILL)  # which has the next hand-in
    output, _ = grading.communicate(timeout=3.0 * TIMEOUT)
    assert grading.returncode == 0, output
    expect_everybody_once(group, output, not_gradable={})
    assert len(stamps(group)) == 5


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("group", [4], indirect=True)
def test_interrupted_class_resumes_without_repeating_a_hand_in_and_names_what_is_not_gradable(
    group, start, tmp_path, monkeypatch
):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    first = grade_class(start, group)
    wait_for(lambda: len(stamps(group)) >= 1, "a first result")
    with busy_processes():
        os.killpg(first.pid, signal.SIGINT)
        output, _ = first.communicate(timeout=TIMEOUT)
    assert (first.returncode, "Traceback" in output) == (130, False), output
    assert list(scratch.iterdir()) == []
    assert processes_mentioning(scratch) == []
    done, told = stamps(group), len(rows(group))
    assert f"interrupted: {told} of 4 graded; run the same command again to continue" in output
    assert told <= len(done) < 4, "the last one may be stored and not yet told"
    places = {name: os.stat(group.parent / "results" / name).st_ino for name in done}

    (group / "late.txt").write_text("no Python")
    second = grade_class(start, group)
    output, _ = second.communicate(timeout=3.0 * TIMEOUT)
    assert second.returncode == 1, output  # of the one that is not gradable
    assert f"5 handed in, {len(done)} of them already graded" in output
    expect_everybody_once(group, output, not_gradable={"late.txt": "a .txt file: expected a folder"})
    assert {name: os.stat(group.parent / "results" / name).st_ino for name in done} == places
    assert all(stamps(group)[name] == done[name] for name in done)


@pytest.mark.slow
def test_interrupted_while_workers_start_it_leaves_nothing_and_prints_no_traceback(group, start, tmp_path, monkeypatch):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    grading = grade_class(start, group)
    with busy_processes():
        assert any("scenarios: seed" in grading.stdout.readline() for _ in range(3))
        wait_for(lambda: len(processes_mentioning(scratch)) >= 4, "four processes of the grading")
        os.killpg(grading.pid, signal.SIGINT)
        output, _ = grading.communicate(timeout=TIMEOUT)
    assert (grading.returncode, "Traceback" in output) == (130, False), output
    wait_for(lambda: processes_mentioning(scratch) == [], "all its processes ended")
    assert list(scratch.iterdir()) == []


STRANGER = """
import socket, ssl, sys
context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
with context.wrap_socket(socket.create_connection(("127.0.0.1", int(sys.argv[1])), timeout=30.0)) as stream:
    print("received", stream.recv(1))
"""


def test_local_scheduler_rejects_another_users_client_without_the_key_of_the_run():
    other = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    with connected("", 1) as client:
        address = client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        done = subprocess.run(
            [*other, "/usr/bin/python3", "-I", "-c", STRANGER, address.split(":")[-1]],
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            cwd="/tmp",
        )
        assert done.returncode != 0 and "alert certificate required" in done.stderr, done.stdout + done.stderr
        assert client.submit(sum, [1, 2]).result(timeout=TIMEOUT) == 3
