"""The same run twice is the same to the last byte, whatever else the machine does; and nothing can hang it.

Every run has fresh processes on one master. Processes with plain signals rather than rostest: they are started and
stopped many times, and one of them is frozen.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml

from aro_robocop_goto_as.loopback import free_port

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DEADLINE = 120.0  # [s, wall] for anything to come; reached only when it never would
RUNS = 10  # of each kind, quiet and with a hog: twenty in all
pytestmark = pytest.mark.timeout(900)


class Ros:
    """A master of its own, and the nodes that a test starts on it."""

    def __init__(self, folder):
        self.port = free_port()
        self.folder = folder
        self.environment = {
            **os.environ, "ROS_HOSTNAME": "localhost", "ROS_MASTER_URI": f"http://localhost:{self.port}",
            "ROS_HOME": str(folder), "ROS_LOG_DIR": str(folder / "log")}
        self.environment.pop("ROS_IP", None)
        self.processes = []
        self.logs = 0
        self.master = self.start("roscore", "-p", str(self.port))
        self.wait(lambda: self.call("rosparam", "set", "/use_sim_time", "true").returncode == 0, "the master")

    def start(self, *command):
        self.logs += 1
        log = self.folder / f"{self.logs}-{Path(command[0]).name}.log"
        with open(log, "wb") as output:
            process = subprocess.Popen(command, env=self.environment, stdout=output, stderr=subprocess.STDOUT)
        process.log = log
        self.processes.append(process)
        return process

    def node(self, script, *arguments):
        return self.start("rosrun", "aro_robocop_goto_as", script, *arguments)

    def script(self, name, *arguments):
        return self.start(sys.executable, str(HERE / name), *map(str, arguments))

    def call(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=DEADLINE)

    def parameters(self, node, values):
        path = self.folder / "parameters.yaml"
        path.write_text(yaml.safe_dump(values))
        self.call("rosparam", "delete", node)
        assert self.call("rosparam", "load", str(path), node).returncode == 0

    def simulator(self, **changes):
        """A simulator in lockstep that stands at time zero."""
        values = yaml.safe_load((ROOT / "config" / "sim.yaml").read_text())
        values.update({"sync": "lockstep", "start_paused": True, "real_time_factor": 0.0, **changes})
        self.parameters("/robocop_sim", values)
        simulator = self.node("robocop_sim.py", "__name:=robocop_sim")
        self.wait(lambda: self.call("rosservice", "type", "/robocop_sim/step").returncode == 0, "the simulator",
                  (simulator,))
        return simulator

    def wait(self, condition, what, processes=()):
        end = time.monotonic() + DEADLINE
        while not condition():
            for process in processes:
                assert process.poll() in (None, 0), f"{process.args} ended: {process.log.read_text()[-3000:]}"
            assert time.monotonic() < end, f"not within {DEADLINE:g} s: {what}"
            time.sleep(0.02)

    def stop(self, *processes):
        for process in processes:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in processes:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            self.processes.remove(process)

    def close(self):
        self.stop(*reversed(self.processes))


@pytest.fixture
def ros(tmp_path):
    it = Ros(tmp_path)
    yield it
    it.close()


@pytest.fixture
def hog():
    """Two processes that leave no core idle."""
    hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    yield
    for process in hogs:
        process.kill()
        process.wait()


def run_scenario(ros, bag=None, **changes):
    """One run in fresh processes: its summary."""
    result = ros.folder / "result.json"
    result.unlink(missing_ok=True)
    ros.parameters("/aro_robocop_goto_as_node", {})
    simulator = ros.simulator(**changes)
    server = ros.node("robocop_goto_as.py", "__name:=aro_robocop_goto_as_node")
    scenario = ros.script("lockstep_scenario.py", result, *([bag] if bag else []))
    ros.wait(lambda: scenario.poll() is not None, "the scenario's end", (simulator, server, scenario))
    assert scenario.returncode == 0, scenario.log.read_text()[-3000:]
    ros.stop(scenario, server, simulator)
    return json.loads(result.read_text())


def assert_all_the_same(runs):
    assert runs[0]["words"] == ["REACHED", "REACHED", "PREEMPTED", "REACHED", "OBSTACLE"]
    assert runs[0]["counts"]["/ground_truth_odom"] == 38 * 30
    for number, run in enumerate(runs, 1):
        assert run["misses"] == 0
        assert run == runs[0], f"run {number} differs from run 1"


def test_a_seeded_scenario_is_byte_identical_in_every_run(ros):
    assert_all_the_same([run_scenario(ros) for _ in range(RUNS)])


def test_a_seeded_scenario_is_byte_identical_on_a_machine_without_an_idle_core(ros, hog):
    assert_all_the_same([run_scenario(ros) for _ in range(RUNS)])


def test_speed_does_not_matter_and_another_seed_is_other_noise_with_the_same_outcome(ros):
    fast, at_most_eight, other = (run_scenario(ros), run_scenario(ros, real_time_factor=8.0), run_scenario(ros, seed=7))
    assert fast == at_most_eight
    assert other["words"] == fast["words"]
    assert other["digests"]["/scan"] != fast["digests"]["/scan"]


def test_a_rosbag_of_a_run_plays_back_every_message(ros):
    bag = ros.folder / "run.bag"
    run = run_scenario(ros, bag)
    counter = ros.script("count_messages.py", ros.folder / "counts.json", *run["counts"])
    ready = ros.folder / "counts.json.ready"
    ros.wait(ready.exists, "the counter listens", (counter,))
    player = ros.start("rosrun", "rosbag", "play", "--quiet", "--rate=20", "--wait-for-subscribers", str(bag))
    ros.wait(lambda: player.poll() is not None, "the end of the bag", (player, counter))
    ros.wait(lambda: json.loads((ros.folder / "counts.json").read_text()) == run["counts"],
             f"all of {run['counts']}", (counter,))


def status_of(ros):
    answer = ros.call("rostopic", "echo", "-n", "1", "/robocop_sim/status")
    return yaml.safe_load(answer.stdout.split("---")[0]) if answer.returncode == 0 else {}


def step(ros, seconds):
    answer = ros.call("rosservice", "call", "/robocop_sim/step", f"duration: {seconds}")
    assert "success: True" in answer.stdout, answer
    return answer


def recorded(ros, simulator):
    """A simulator at one second, since rospy takes time zero for no time at all, and the file of its true poses."""
    trajectory = ros.folder / "trajectory"
    trajectory.unlink(missing_ok=True)
    recorder = ros.script("trajectory.py", trajectory)
    ros.wait(trajectory.exists, "the recorder listens", (simulator, recorder))
    step(ros, 1.0)
    return trajectory, recorder


def poses_at(ros, trajectory, seconds):
    """All true poses once simulated time stands at so many seconds."""
    ros.wait(lambda: len(trajectory.read_text().splitlines()) == round(30 * seconds), f"the poses of {seconds} s")
    return trajectory.read_text().splitlines()


def start_metronome(ros, simulator, rate=10):
    controller = ros.script("metronome.py", f"_rate:={rate}")
    ros.wait(lambda: "/metronome" in status_of(ros).get("drivers", []), "it drives", (simulator, controller))
    return controller


def run_metronome(ros):
    """Ten seconds with a plain controller: the true poses, and how often it was given up on."""
    simulator = ros.simulator(cmd_vel_timeout=0.0)
    trajectory, recorder = recorded(ros, simulator)
    controller = start_metronome(ros, simulator)
    step(ros, 10.0)
    poses = poses_at(ros, trajectory, 11.0)
    misses = status_of(ros)["lockstep_misses"]
    ros.stop(controller, recorder, simulator)
    return poses, misses


def test_a_controller_that_knows_nothing_of_lockstep_gives_the_same_trajectory(ros, hog):
    first, misses = run_metronome(ros)
    assert misses == 0
    assert len(set(first)) > 290, "the robot did not move"
    for _ in range(2):
        assert run_metronome(ros) == (first, 0)


@pytest.mark.parametrize("rate", [3, 4])
def test_a_loop_whose_period_is_no_whole_number_of_ticks_costs_no_miss(ros, rate):
    simulator = ros.simulator(cmd_vel_timeout=0.0)
    step(ros, 1.0)
    start_metronome(ros, simulator, rate)
    step(ros, 30.0)
    status = status_of(ros)
    assert (status["lockstep_misses"], status["drivers"]) == (0, ["/metronome"])


def test_a_controller_that_hangs_costs_one_time_out_and_is_followed_again_when_it_is_back(ros):
    simulator = ros.simulator(lockstep_timeout=0.5)
    step(ros, 1.0)
    controller = start_metronome(ros, simulator)
    step(ros, 1.0)
    controller.send_signal(signal.SIGSTOP)
    step(ros, 3.0)
    status = status_of(ros)
    controller.send_signal(signal.SIGCONT)
    assert status["lockstep_misses"] == 1 and status["drivers"] == []
    assert "no answer within 0.5 s from /metronome" in simulator.log.read_text()
    ros.wait(lambda: step(ros, 0.1) and "/metronome" in status_of(ros)["drivers"], "it drives again", (simulator,))


def test_a_controller_that_is_killed_stops_neither_time_nor_leaves_the_robot_driving(ros):
    simulator = ros.simulator(cmd_vel_timeout=0.0)
    server = ros.node("robocop_goto_as.py", "__name:=aro_robocop_goto_as_node")
    trajectory, _ = recorded(ros, simulator)
    ros.wait(lambda: "/aro_robocop_goto_as_node" in status_of(ros).get("drivers", []), "it drives", (simulator, server))
    goal = ros.start("rostopic", "pub", "-1", "/robocop_goto_as/goal", "aro_robocop_goto_as/GoToPositionActionGoal",
                     "{goal: {position: {x: 3.0}}}")
    ros.wait(lambda: "goal accepted" in server.log.read_text(), "the goal", (server, goal))
    step(ros, 2.0)
    server.kill()
    server.wait()
    step(ros, 2.0)
    poses = poses_at(ros, trajectory, 5.0)
    assert len(set(poses[30:90])) > 50, "it did not drive"
    assert len(set(poses[-30:])) == 1, "it still drives"
