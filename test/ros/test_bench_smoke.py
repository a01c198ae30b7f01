"""`robocop bench` as a whole: it reports every figure, loses no message, and leaves no process behind."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from processes import processes_with

ROOT = Path(__file__).resolve().parents[2]
COMMAND = [sys.executable, str(ROOT / "test" / "robocop_bench.py")]
DEADLINE = 600.0  # [s, wall] on a busy machine
pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


@pytest.fixture
def environment(tmp_path):
    """A setting by which the processes of the bench are recognised, of which none may be left."""
    yield {**os.environ, "BENCH_TEST": str(tmp_path)}
    assert processes_with(f"BENCH_TEST={tmp_path}") == []


def test_two_checkouts_are_measured_in_turn_with_every_figure_and_no_message_lost(environment):
    names = ["kinematic:2", "kinematic:rospy", "kinematic:server"]
    options = ["--quick", "--json", "--seconds", "0.5", "--against", str(ROOT), "--cases", *names]
    done = subprocess.run([*COMMAND, *options], env=environment, text=True, capture_output=True, timeout=DEADLINE)
    assert done.returncode == 0, done.stderr
    cases = json.loads(done.stdout)["cases"]
    assert [case["case"] for case in cases] == names
    for case in cases:
        assert all(len(values) == 1 and values[0] > 0.0 for values in case["ratios"].values())
        for side in ("other", "this"):
            figures = case[side]["figures"]
            assert (case[side]["error"], figures.pop("lost")) == (None, [0])
            assert {"factor", "cpu_ms", "memory_mb", "first_scan_s", "client_busy", "messages"} <= set(figures)
            assert all(value > 0.0 for (value,) in figures.values())


def test_a_case_that_fails_is_reported_and_the_others_continue(tmp_path, environment):
    failing = tmp_path / "lib" / "aro_robocop_goto_as" / "robocop_sim.py"
    failing.parent.mkdir(parents=True)
    failing.write_text("#!/bin/sh\necho this one is broken\nexit 5\n")
    failing.chmod(0o755)
    bench = subprocess.run(
        [*COMMAND, "--quick", "--seconds", "0.1", "--cases", "kinematic:1", "wheels:1"],
        env={**environment, "ROBOCOP_WS": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
    )
    assert bench.returncode == 1
    for name in ("kinematic:1", "wheels:1"):
        assert f"{name}: failed: the simulator ended with status 5: this one is broken" in bench.stdout


def test_an_interrupted_bench_prints_what_was_measured_until_then(environment):
    command = [*COMMAND, "--json", "--seconds", "0.1", "--repeats", "100000", "--cases", "kinematic:1"]
    bench = subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for line in bench.stderr:
        if ", 2 of " in line:
            break
    bench.send_signal(signal.SIGINT)
    output, errors = bench.communicate(timeout=DEADLINE)
    assert bench.returncode == 130, errors
    report = json.loads(output)
    assert report["conditions"][-1].startswith("Interrupted")
    assert [len(case["this"]["figures"]["factor"]) for case in report["cases"]] == [1]
