"""Lockstep: runs are identical to the last byte. Every run has new processes on one master."""

import json
import sys
from pathlib import Path

import pytest
from systems import System

NODES = Path(__file__).with_name("nodes")
SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
SIMULATOR, SERVER = "/robocop_sim", "/aro_robocop_goto_as_node"
pytestmark = pytest.mark.xdist_group("lockstep")  # for the master and the reference run that the tests share


class Ros(System):
    """A master, and the nodes of one run after another on it."""

    def __init__(self, folder):
        super().__init__(folder)
        self.core = self.start_master()

    def run_scenario(self, **parameters):
        """One run in new processes, with these parameters of the simulator: its summary."""
        result = self.directory / "result.json"
        values = {"sync": "lockstep", "start_paused": True, "real_time_factor": 0.0, **parameters}
        self.master.setParam(SIMULATOR, values)
        nodes = [
            self.start("simulator", SCRIPTS / "robocop_sim.py", f"__name:={SIMULATOR[1:]}"),
            self.start("server", SCRIPTS / "robocop_goto_as.py", f"__name:={SERVER[1:]}"),
        ]
        scenario = self.start("scenario", sys.executable, NODES / "lockstep_scenario.py", result)
        self.wait(lambda: scenario.poll() is not None, "the scenario's end", *nodes, scenario)
        assert scenario.returncode == 0, scenario.output[-3000:]
        self.end_all(self.core)
        return json.loads(result.read_text())


@pytest.fixture(scope="module")
def ros(tmp_path_factory):
    with Ros(tmp_path_factory.mktemp("lockstep")) as ros:
        yield ros


@pytest.fixture(scope="module")
def reference(ros):
    """The summary of one run of the scenario."""
    run = ros.run_scenario()
    assert run["words"] == ["REACHED", "PREEMPTED", "OBSTACLE"]
    assert run["counts"]["/ground_truth_odom"] == 14 * 30
    assert run["misses"] == 0
    return run


def test_a_seeded_scenario_is_byte_identical_in_another_run(ros, reference):
    assert ros.run_scenario() == reference


@pytest.mark.slow
def test_real_time_factor_does_not_change_the_run(ros, reference):
    assert ros.run_scenario(real_time_factor=8.0) == reference
