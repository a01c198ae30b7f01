"""Lockstep: runs are identical to the last byte. Every run has new processes on one master."""

import itertools
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
    """A master, and the nodes that a test starts on it."""

    def __init__(self, folder):
        super().__init__(folder)
        self.numbers = itertools.count()
        self.core = self.start_master()

    def node(self, script, *arguments):
        return self.start(f"{next(self.numbers)}-{script}", SCRIPTS / script, *arguments)

    def script(self, name, *arguments, **streams):
        return self.start(f"{next(self.numbers)}-{name}", sys.executable, NODES / name, *arguments, **streams)

    def set_parameters(self, node, values):
        """Replace all parameters of a node."""
        if self.master.hasParam(node):
            self.master.deleteParam(node)
        if values:
            self.master.setParam(node, values)

    def simulator(self, **changes):
        """A simulator in lockstep that stands at time zero."""
        values = {"sync": "lockstep", "start_paused": True, "real_time_factor": 0.0, **changes}
        self.set_parameters(SIMULATOR, values)
        simulator = self.node("robocop_sim.py", "__name:=robocop_sim")
        self.wait(lambda: self.offers(f"{SIMULATOR}/step"), "the simulator", simulator)
        return simulator

    def stop_nodes(self):
        """End everything but the master."""
        self.end_all(self.core)


@pytest.fixture(scope="module")
def shared_ros(tmp_path_factory):
    ros = Ros(tmp_path_factory.mktemp("lockstep"))
    with ros:
        yield ros


@pytest.fixture
def ros(shared_ros):
    """The master that all tests share; their nodes end with each of them."""
    yield shared_ros
    shared_ros.stop_nodes()


@pytest.fixture(scope="module")
def reference(shared_ros):
    """The summary of one run of the scenario."""
    run = run_scenario(shared_ros)
    assert run["words"] == ["REACHED", "PREEMPTED", "OBSTACLE"]
    assert run["counts"]["/ground_truth_odom"] == 14 * 30
    assert run["misses"] == 0
    return run


def run_scenario(ros, **changes):
    """One run in new processes: its summary."""
    result = ros.directory / "result.json"
    result.unlink(missing_ok=True)
    ros.set_parameters(SERVER, {})
    simulator = ros.simulator(**changes)
    server = ros.node("robocop_goto_as.py", f"__name:={SERVER[1:]}")
    scenario = ros.script("lockstep_scenario.py", result)
    ros.wait(lambda: scenario.poll() is not None, "the scenario's end", simulator, server, scenario)
    assert scenario.returncode == 0, scenario.output[-3000:]
    ros.stop_nodes()
    return json.loads(result.read_text())


def test_a_seeded_scenario_is_byte_identical_in_another_run(ros, reference):
    assert run_scenario(ros) == reference


@pytest.mark.slow
def test_real_time_factor_does_not_change_the_run(ros, reference):
    assert run_scenario(ros, real_time_factor=8.0) == reference
