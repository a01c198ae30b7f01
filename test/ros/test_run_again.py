"""`./robocop run` on a ROS master that keeps running."""

import os
import signal
from pathlib import Path

import pytest
from systems import System

ROBOCOP = Path(__file__).resolve().parents[2] / "robocop"
RUNS = "robot at x"  # in the output of a simulator that runs


@pytest.mark.slow
def test_it_runs_again_where_the_master_still_lists_a_simulator_that_has_ended(tmp_path):
    with System(tmp_path) as ros:
        ros.start_master()

        def run(name):
            return ros.start(name, ROBOCOP, "run", "--verbose", "rviz:=false", "world:=empty", "drive:=kinematic")

        first = run("first")
        ros.wait(lambda: RUNS in first.output, "the simulator runs", first)
        second = run("second")
        assert second.wait_for_exit() == 1
        assert "a simulator is already running on" in second.output

        for process in ros.processes("robocop_sim.py"):
            os.kill(process, signal.SIGKILL)  # it can't unregister
        assert first.wait_for_exit() == 1
        assert ros.master.lookupNode("/robocop_sim"), "the master does not list it any more: this test shows nothing"

        third = run("third")
        ros.wait(lambda: RUNS in third.output, "the simulator runs again", third)
        third.interrupt()
        assert third.wait_for_exit() == 0
