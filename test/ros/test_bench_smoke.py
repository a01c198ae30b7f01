"""`robocop bench` as a whole: it reports every figure, loses no message, and leaves no process behind."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from processes import processes_with

COMMAND = [sys.executable, str(Path(__file__).resolve().parents[1] / "robocop_bench.py")]
DEADLINE = 120.0  # [s, wall] on a busy machine


def start(tmp_path, *arguments):
    """Start the bench with a setting in its environment by which its processes are recognised."""
    environment = {**os.environ, "BENCH_TEST": str(tmp_path)}
    return subprocess.Popen(
        [*COMMAND, *arguments],
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def running(tmp_path, word=b""):
    """Processes of the bench with this directory that still run, with a word on their command line."""
    return processes_with(b"BENCH_TEST=" + os.fsencode(tmp_path), word)


@pytest.mark.slow
def test_one_case_yields_every_figure_and_loses_no_message(tmp_path):
    bench = start(tmp_path, "--quick", "--json", "--seconds", "1", "--cases", "kinematic:2")
    output, errors = bench.communicate(timeout=DEADLINE)
    assert bench.returncode == 0, errors
    (case,) = json.loads(output)["cases"]
    figures = case["this"]["figures"]
    assert (case["case"], case["this"]["error"], figures.pop("lost")) == ("kinematic:2", None, [0])
    assert figures["messages"][0] > 2 * 35
    assert {"factor", "cpu_ms", "memory_mb", "first_scan_s", "client_busy"} <= set(figures)
    assert all(value > 0.0 for (value,) in figures.values())
    assert figures["client_busy"][0] < 0.5
    assert running(tmp_path) == []


@pytest.mark.slow
def test_a_case_that_fails_is_reported_and_the_others_continue(tmp_path):
    failing = tmp_path / "lib" / "aro_robocop_goto_as" / "robocop_sim.py"
    failing.parent.mkdir(parents=True)
    failing.write_text("#!/bin/sh\necho this one is broken\nexit 5\n")
    failing.chmod(0o755)
    bench = subprocess.run(
        [*COMMAND, "--quick", "--seconds", "0.1", "--cases", "kinematic:1", "wheels:1"],
        env={**os.environ, "ROBOCOP_WS": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
    )
    assert bench.returncode == 1
    for name in ("kinematic:1", "wheels:1"):
        assert f"{name}: failed: the simulator ended with status 5: this one is broken" in bench.stdout


@pytest.mark.slow
def test_an_interrupted_bench_prints_what_was_measured_until_then(tmp_path):
    bench = start(tmp_path, "--json", "--seconds", "0.1", "--repeats", "100000", "--cases", "kinematic:1")
    for line in bench.stderr:
        if ", 2 of " in line:
            break
    bench.send_signal(signal.SIGINT)
    output, errors = bench.communicate(timeout=DEADLINE)
    assert bench.returncode == 130, errors
    report = json.loads(output)
    assert report["conditions"][-1].startswith("Interrupted")
    assert [len(case["this"]["figures"]["factor"]) for case in report["cases"]] == [1]
    assert running(tmp_path) == []
