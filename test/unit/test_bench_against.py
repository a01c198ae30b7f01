"""`robocop bench --against`: its cases, the other checkout's environment, and the report."""

import json
from pathlib import Path

import pytest

from aro_robocop_goto_as.bench import against
from aro_robocop_goto_as.bench.cases import Case, lockstep_cases, parse_cases
from aro_robocop_goto_as.bench.report import conditions
from aro_robocop_goto_as.bench.results import Measured, Run
from aro_robocop_goto_as.errors import BenchError


def run(factor, cpu):
    return Run(factor, cpu, 50_000_000, 1.5, expected=70, delivered=70, client_busy=0.1)


def comparison(name, factors, cpus, left_out=None):
    """Two repeats on each side: factors and CPU times as (other, this) pairs."""
    (case,) = parse_cases([name])
    both = [Measured(case), Measured(case)]
    for side, measured in enumerate(both):
        measured.fastest = [run(pair[side], 0.01) for pair in factors]
        measured.paced = [run(1.0, pair[side]) for pair in cpus]
    one = against.Comparison(case, *both, left_out)
    one.add_ratios()
    return one


def test_lockstep_cases_are_named_by_their_controller_and_run_in_lockstep():
    names = ["wheels:rospy", "wheels:server", "kinematic:rospy", "kinematic:server"]
    assert [case.name for case in lockstep_cases()] == names
    assert parse_cases(names) == lockstep_cases()
    assert all(case.params(0.0)["sync"] == "lockstep" and case.robots == 1 for case in lockstep_cases())
    assert "sync" not in Case("wheels", 1).params(0.0)


def test_repeats_are_compared_in_pairs_and_failed_cases_are_listed():
    compared = comparison("kinematic:1", [(100.0, 300.0), (50.0, 100.0)], [(0.02, 0.01), (0.02, 0.005)])
    refused = comparison("wheels:rospy", [], [], "the other checkout: the simulator ended with status 1: sync")
    text = against.table([compared, refused], Path("/other"), conditions(1.0, 2))
    cells = [cell.strip() for cell in text.split("\n")[-3].split("|")]
    assert cells[1:6] == ["kinematic:1", "75 -> 200", "2.50 (2.00-3.00)", "20 -> 7.5", "0.38 (0.25-0.50)"]
    assert text.endswith("\nwheels:rospy left out: the other checkout: the simulator ended with status 1: sync")


def test_json_has_every_run_and_every_ratio():
    compared = comparison("kinematic:1", [(100.0, 300.0)], [(0.02, 0.01)])
    (case,) = json.loads(against.as_json([compared], Path("/other"), conditions(1.0, 1)))["cases"]
    assert case["ratios"] == {"factor": [3.0], "cpu_ms": [0.5], "memory_mb": [1.0], "first_scan_s": [1.0]}
    assert (case["other"]["fastest"][0]["factor"], case["this"]["fastest"][0]["factor"]) == (100.0, 300.0)


def test_folder_that_is_not_a_checkout_is_refused(tmp_path):
    with pytest.raises(
        BenchError, match=f"^--against {tmp_path}: expected a checkout .* {tmp_path}/robocop is missing"
    ):
        against.other_checkout(tmp_path)


@pytest.mark.parametrize("script", ["exit 3", "printf 'A=1\\0'"])
def test_checkout_whose_shell_does_not_work_is_refused(tmp_path, script):
    (tmp_path / "robocop").write_text(f"#!/bin/sh\n{script}\n")
    (tmp_path / "robocop").chmod(0o755)
    with pytest.raises(BenchError, match=f"^--against {tmp_path}: its ./robocop shell failed with status [03]$"):
        against.other_checkout(tmp_path)


def test_other_checkout_uses_its_own_workspace_and_the_measurements_ros_master(tmp_path, monkeypatch):
    (tmp_path / "robocop").write_text(
        '#!/bin/sh\nexport ROBOCOP_WS=/other/devel ROS_MASTER_URI=old; shift; exec "$@"\n'
    )
    (tmp_path / "robocop").chmod(0o755)
    monkeypatch.setenv("ROBOCOP_STATE", "/mine/.robocop")
    monkeypatch.setenv("PYTHONPATH", "/mine/.robocop/ws/devel/lib/python3:/theirs/lib")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "/mine/.robocop/ws/devel")
    checkout = against.other_checkout(tmp_path)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:1")
    environment = checkout.environment()
    assert checkout.programs == Path("/other/devel/lib/aro_robocop_goto_as")
    assert (environment["PYTHONPATH"], environment["ROS_MASTER_URI"]) == ("/theirs/lib", "http://localhost:1")
    assert "CMAKE_PREFIX_PATH" not in environment
