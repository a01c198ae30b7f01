"""`robocop bench --against` as a whole: this checkout against itself, with every kind of controller."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from processes import processes_with

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = 240.0  # [s, wall] on a busy machine


@pytest.mark.slow
def test_two_checkouts_are_measured_in_turn_and_nothing_is_left_behind(tmp_path):
    done = subprocess.run(
        [sys.executable, str(ROOT / "test" / "robocop_bench.py"), "--quick", "--json", "--seconds", "0.5"]
        + ["--against", str(ROOT), "--cases", "kinematic:rospy", "kinematic:server"],
        env={**os.environ, "BENCH_TEST": str(tmp_path)},
        text=True,
        capture_output=True,
        timeout=DEADLINE,
    )
    assert done.returncode == 0, done.stderr
    cases = json.loads(done.stdout)["cases"]
    assert [case["case"] for case in cases] == ["kinematic:rospy", "kinematic:server"]
    for case in cases:
        assert all(len(values) == 1 and values[0] > 0.0 for values in case["ratios"].values())
        for side in ("other", "this"):
            assert (case[side]["error"], case[side]["figures"]["lost"]) == (None, [0])
    assert processes_with(b"BENCH_TEST=" + os.fsencode(tmp_path)) == []
