"""`robocop bench` as a whole: its figures are there, nothing is lost, and it leaves nothing behind."""
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "robocop_bench.py"
DEADLINE = 120.0  # [s, wall] on a busy machine


def start(tmp_path, *arguments):
    """The bench, in an environment that tells it and all that it starts from other processes."""
    environment = {**os.environ, "BENCH_TEST": str(tmp_path)}
    return subprocess.Popen([sys.executable, str(SCRIPT), *arguments], env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def command_lines(tmp_path):
    """Of every process that a bench with this directory has started and that still runs."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if b"BENCH_TEST=" + os.fsencode(tmp_path) in (process / "environ").read_bytes().split(b"\0"):
                found.append((process / "cmdline").read_bytes())
        except OSError:  # ended meanwhile, or somebody else's
            continue
    return found


def test_one_case_yields_every_figure_and_loses_no_message(tmp_path):
    bench = start(tmp_path, "--quick", "--json", "--seconds", "1", "--cases", "kinematic:2")
    output, errors = bench.communicate(timeout=DEADLINE)
    assert bench.returncode == 0, errors
    (case,) = json.loads(output)["cases"]
    assert (case["robots"], case["error"], case["lost"]) == (2, None, 0)
    assert case["delivered"] > 2 * 35
    assert set(case["median"]) == {"factor", "floor", "of_floor", "cpu_ms", "memory_mb", "first_scan_s"}
    assert all(value > 0.0 for value in case["median"].values())
    assert command_lines(tmp_path) == []


def test_a_case_that_fails_is_told_and_the_others_go_on(tmp_path):
    failing = tmp_path / "robocop_sim.py"
    failing.write_text("#!/bin/sh\necho this one is broken\nexit 5\n")
    failing.chmod(0o755)
    (tmp_path / SCRIPT.name).write_text(SCRIPT.read_text())
    bench = subprocess.run([sys.executable, str(tmp_path / SCRIPT.name), "--quick", "--seconds", "0.1", "--cases",
                            "kinematic:1", "wheels:1"], capture_output=True, text=True, timeout=DEADLINE)
    assert bench.returncode == 1
    for name in ("kinematic:1", "wheels:1"):
        assert f"{name} failed: the simulator ended with status 5: this one is broken" in bench.stdout


def test_an_interrupt_ends_all_that_was_started(tmp_path):
    bench = start(tmp_path, "--seconds", "600", "--cases", "wheels:1")
    deadline = time.monotonic() + DEADLINE
    while not any(b"bench.floor" in line for line in command_lines(tmp_path)):
        assert bench.poll() is None and time.monotonic() < deadline
        time.sleep(0.05)
    bench.send_signal(signal.SIGINT)
    output, errors = bench.communicate(timeout=DEADLINE)
    assert (bench.returncode, output) == (130, ""), errors
    assert command_lines(tmp_path) == []
