"""bench.checkout: programs and environment of the other checkout."""

from pathlib import Path

import pytest

from aro_robocop_goto_as.bench.checkout import other_checkout
from aro_robocop_goto_as.errors import BenchError


@pytest.fixture
def robocop(tmp_path):
    """Writes the command of a checkout in tmp_path."""

    def write(script):
        (tmp_path / "robocop").write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / "robocop").chmod(0o755)

    return write


def test_folder_that_is_not_a_checkout_is_refused(tmp_path):
    expected = f"^--against {tmp_path}: expected a checkout of this project: .*{tmp_path}/robocop"
    with pytest.raises(BenchError, match=expected):
        other_checkout(tmp_path)


@pytest.mark.parametrize("script, reason", [("exit 3", "status 3"), ("printf 'A=1\\0'", "does not set ROBOCOP_WS")])
def test_checkout_whose_shell_does_not_work_is_refused(tmp_path, robocop, script, reason):
    robocop(script)
    with pytest.raises(BenchError, match=f"^--against {tmp_path}: .*{reason}"):
        other_checkout(tmp_path)


def test_other_checkout_uses_its_own_workspace_and_the_measurements_ros_master(tmp_path, robocop, monkeypatch):
    robocop('export ROBOCOP_WS=/other/devel ROS_MASTER_URI=old; shift; exec "$@"')
    monkeypatch.setenv("ROBOCOP_STATE", "/mine/.robocop")
    monkeypatch.setenv("PYTHONPATH", "/mine/.robocop/ws/devel/lib/python3:/theirs/lib")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "/mine/.robocop/ws/devel")
    checkout = other_checkout(tmp_path)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:1")
    environment = checkout.environment()
    assert checkout.programs == Path("/other/devel/lib/aro_robocop_goto_as")
    assert (environment["PYTHONPATH"], environment["ROS_MASTER_URI"]) == ("/theirs/lib", "http://localhost:1")
    assert "CMAKE_PREFIX_PATH" not in environment
