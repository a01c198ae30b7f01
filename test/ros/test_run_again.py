"""`./robocop run` on a ROS master that keeps running."""

import os
import signal
import subprocess
import time
import xmlrpc.client
from pathlib import Path

import pytest
from processes import processes_with

from aro_robocop_goto_as.process.ports import free_port

ROBOCOP = Path(__file__).resolve().parents[2] / "robocop"
DEADLINE = 120.0  # [s, wall]
RUNS = "robot at x"  # in the output of a simulator that runs


@pytest.fixture
def environment(tmp_path):
    """The settings of a ROS master of our own; what was started with them is ended."""
    port = free_port()
    settings = {"ROS_HOSTNAME": "localhost", "ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOME": str(tmp_path)}
    with open(tmp_path / "master", "wb") as log:
        subprocess.Popen(["rosmaster", "--core", "-p", str(port)], env={**os.environ, **settings}, stdout=log)
    yield {**os.environ, **settings}
    for process in processes_with(b"ROS_HOME=" + os.fsencode(tmp_path)):
        os.kill(process, signal.SIGKILL)


def simulator_at(environment):
    """Where the master says that the simulator is; "" if it knows none, None as long as no master answers."""
    try:
        return xmlrpc.client.ServerProxy(environment["ROS_MASTER_URI"]).lookupNode("/test", "/robocop_sim")[2]
    except ConnectionRefusedError:
        return None


def run(environment, output, until):
    """Start the command; returns it when `until` is in its output, or when it has ended."""
    with open(output, "wb") as stream:
        command = [str(ROBOCOP), "run", "--verbose", "rviz:=false", "world:=empty", "drive:=kinematic"]
        process = subprocess.Popen(command, env=environment, stdout=stream, stderr=subprocess.STDOUT)
    end = time.monotonic() + DEADLINE
    while until not in output.read_text() and process.poll() is None and time.monotonic() < end:
        time.sleep(0.02)
    return process


@pytest.mark.slow
def test_it_runs_again_where_the_master_still_lists_a_simulator_that_has_ended(environment, tmp_path):
    end = time.monotonic() + DEADLINE
    while simulator_at(environment) is None:
        assert time.monotonic() < end, "no master"
        time.sleep(0.02)

    first = run(environment, tmp_path / "first", RUNS)
    assert RUNS in (tmp_path / "first").read_text()
    second = run(environment, tmp_path / "second", RUNS)
    assert second.wait(DEADLINE) == 1
    assert "a simulator is already running on" in (tmp_path / "second").read_text()

    for process in processes_with(b"ROS_HOME=" + os.fsencode(tmp_path), b"robocop_sim.py"):
        os.kill(process, signal.SIGKILL)  # it can't unregister
    assert first.wait(DEADLINE) == 1
    assert simulator_at(environment), "the master does not list it any more, so this test shows nothing"

    third = run(environment, tmp_path / "third", RUNS)
    assert RUNS in (tmp_path / "third").read_text()
    third.send_signal(signal.SIGINT)
    assert third.wait(DEADLINE) == 0
