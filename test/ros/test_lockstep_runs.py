"""Lockstep: runs are identical to the last byte, and no controller can block time.

Every run has new processes on one master. They are plain processes rather than nodes of a rostest, because they are
started and stopped many times and one of them is frozen by SIGSTOP.
"""

import itertools
import json
import subprocess
import sys
from pathlib import Path

import pytest
from systems import System

NODES = Path(__file__).with_name("nodes")
SIMULATOR, SERVER = "/robocop_sim", "/aro_robocop_goto_as_node"
pytestmark = pytest.mark.xdist_group("lockstep")  # for the master and the reference run that the tests share


class Ros(System):
    """A master, and the nodes that a test starts on it."""

    def __init__(self, folder):
        super().__init__(folder)
        self.numbers = itertools.count()
        self.core = self.start_master()

    def node(self, script, *arguments):
        return self.start(f"{next(self.numbers)}-{script}", "rosrun", "aro_robocop_goto_as", script, *arguments)

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


class Remote:
    """Steps the simulator and reads its status."""

    def __init__(self, ros, simulator):
        self.ros, self.simulator = ros, simulator
        self.process = ros.script("remote.py", stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def _ask(self, request):
        self.process.stdin.write(f"{request}\n".encode())
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        assert answer, f"{self.process.output}\n{self.simulator.output[-3000:]}"
        return json.loads(answer)

    def step(self, seconds):
        answer = self._ask(f"step {seconds}")
        assert answer["success"], answer

    def status(self):
        """The next report from now on."""
        return self._ask("status")


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
    assert run["words"] == ["REACHED", "REACHED", "PREEMPTED", "REACHED", "OBSTACLE"]
    assert run["counts"]["/ground_truth_odom"] == 38 * 30
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


def start_recorder(ros, simulator, remote):
    """Move time to one second, as rospy takes time zero for no time at all; the file of all true poses from there."""
    trajectory = ros.directory / "trajectory"
    trajectory.unlink(missing_ok=True)
    recorder = ros.script("trajectory.py", trajectory)
    ros.wait(trajectory.exists, "the recorder listens", simulator, recorder)
    remote.step(1.0)
    return trajectory


def poses_at(ros, trajectory, seconds):
    """All true poses, once simulated time has reached a value [s]."""
    ros.wait(lambda: len(trajectory.read_text().splitlines()) == round(30 * seconds), f"the poses of {seconds} s")
    return trajectory.read_text().splitlines()


def start_metronome(ros, remote):
    """A plain controller that lockstep waits for, and how many seconds were simulated until it does."""
    controller = ros.script("metronome.py")
    steps = itertools.count(1)
    ros.wait(lambda: remote.step(0.1) or "/metronome" in remote.status()["drivers"] or not next(steps), "it drives")
    return controller, 0.1 * next(steps)


def run_metronome(ros):
    """Fifteen seconds with a plain controller: the true poses, and how often it missed lockstep's timeout."""
    simulator = ros.simulator(cmd_vel_timeout=0.0)
    remote = Remote(ros, simulator)
    trajectory = start_recorder(ros, simulator, remote)
    _, seconds = start_metronome(ros, remote)
    assert seconds < 4.0, "it has been driving before lockstep waits for it"
    remote.step(15.0 - seconds)
    poses = poses_at(ros, trajectory, 16.0)
    misses = remote.status()["lockstep_misses"]
    ros.stop_nodes()
    return poses, misses


@pytest.mark.slow
def test_controller_unaware_of_lockstep_gives_the_same_trajectory_in_another_run(ros):
    poses, misses = run_metronome(ros)
    assert misses == 0
    assert len(set(poses)) > 290, "the robot did not move"
    assert run_metronome(ros) == (poses, 0)
