"""Packages as students write them run unchanged with this simulator, mistakes included."""

import functools
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from students import contents, copy_of
from systems import Program

NODES = Path(__file__).resolve().parent / "nodes"
DEADLINE = 300.0  # [s, wall] for a build and a start on a busy machine
pytestmark = [
    pytest.mark.xdist_group("hosting"),  # the first test builds the workspace that all of them extend
    pytest.mark.timeout(900),  # several times DEADLINE
]


class Hosted(Program):
    """`robocop sim --with PACKAGE` on a master of its own."""

    deadline = DEADLINE

    def __init__(self, package, folder, *arguments):
        super().__init__(folder, "robocop_sim_with.py", package, "world:=empty", *arguments, ROBOCOP_RVIZ="false")

    def wait_for_node(self, name):
        self.wait_until(lambda: name in self.call("rosnode", "list").stdout.split(), f"{name} runs")

    def call(self, *command, **environment):
        return subprocess.run(
            command,
            env={**self.environment, **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=DEADLINE,
        )

    def goto(self, *arguments):
        return self.call("rosrun", "aro_robocop_goto_as", "robocop_goto.py", *arguments)

    def end(self):
        """Interrupt it as by Ctrl-C; the processes that are left."""
        self.process.interrupt()
        self.process.wait(DEADLINE)
        return self.processes()


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """Copies of packages by name; each is copied and so built from nothing only once."""
    home = tmp_path_factory.mktemp("home")
    return functools.lru_cache(maxsize=None)(lambda name: copy_of(name, home))


@pytest.fixture
def hosted(tmp_path, package):
    started = []

    def start(name, *arguments):
        before = contents(package(name))
        started.append((Hosted(package(name), tmp_path, *arguments), package(name), before))
        return started[-1][0]

    yield start
    for system, path, before in started:
        if system.process.poll() is None:
            assert system.end() == []
        system.end_all()
        assert contents(path) == before, "its author's files were changed"


def test_a_package_in_the_style_of_the_lab_is_built_and_reaches_a_goal_with_gazebos_services(hosted):
    system = hosted("as_taught")
    system.wait_until(lambda: "state of the server" in system.output, "its bridge talks to its server")
    done = system.goto("0.3", "0.3")
    assert (done.returncode, "SUCCEEDED: there" in done.stdout) == (0, True), done.stdout + system.output
    assert "PARAMETERS" not in system.output
    assert "world         empty\nrobot         burger\ntransforms    none from odom to the robot" in system.output
    types = Path(os.environ["ROBOCOP_STATE"], "compat", "devel", "lib", "python3", "dist-packages")
    output = system.call(
        sys.executable, str(NODES / "gazebo_calls.py"), PYTHONPATH=f"{os.environ['PYTHONPATH']}:{types}"
    ).stdout
    answers = json.loads(output.splitlines()[-1])
    assert answers.pop("models") == ["ground_plane", "turtlebot3_burger"]
    absent = "model [table] does not exist; there are: ground_plane, turtlebot3_burger"
    assert answers.pop("unknown")[3].startswith(absent) and answers.pop("unknown set") == absent
    positions = {
        name: answers.pop(name)[:3] for name in ("position", "relative", "then", "reset_world", "reset_simulation")
    }
    assert positions == {
        "position": [True, 0.5, -0.25],
        "relative": [True, 0.0, 0.0],
        "then": [True, 1.0, -0.25],
        "reset_world": [True, 0.0, 0.0],
        "reset_simulation": [True, 0.0, 0.0],
    }
    assert answers.pop("table")[:3] == [True, 2.0, 0.0] and answers.pop("table moved")[:3] == [True, 1.0, 1.0]
    assert answers.pop("spawned nonsense") == "SpawnModel: "
    assert answers == {
        "spawned": True,
        "spawned twice": False,
        "deleted": True,
        "deleted a robot": False,
        "light": True,
        "refused": [],
        "set": True,
        "paused": True,
        "moved by itself": True,
        "time": True,
    }


@pytest.mark.slow
def test_scripts_without_a_launch_file_are_started_and_a_misspelt_action_is_reported(hosted):
    system = hosted("timer_driven")
    system.wait_for_node("/aro_robocop_goto_as_node")
    assert "src/robocop_goto_as.py is not executable" in system.output
    done = system.goto("0.3", "0.0")
    assert done.returncode == 1
    assert "there is '/robovop_goto_as' of the same type: a misspelt name?" in done.stdout
    # It publishes each command once, so commands have to stay in force.
    published = system.call(
        "rostopic",
        "pub",
        "-1",
        "/robovop_goto_as/goal",
        "aro_robocop_goto_as/GoToPositionActionGoal",
        "{goal: {position: {x: -0.3, y: 0.2}}}",
    )
    assert published.returncode == 0, published.stdout
    answer = system.call("rostopic", "echo", "-n", "1", "/robovop_goto_as/result")
    assert 'message: "reached"' in answer.stdout, answer.stdout + system.output


@pytest.mark.slow
def test_a_launch_file_of_another_name_gets_its_argument_and_a_crash_on_the_second_goal_is_reported(hosted):
    system = hosted("functions_only", "speed:=0.1")
    system.wait_for_node("/aro_robocop_goto_as_node")
    assert system.goto("0.3", "0.0").returncode == 0
    speed = system.call("rosparam", "get", "/aro_robocop_goto_as_node/speed")
    assert speed.stdout.strip() == "0.1"
    second = system.goto("0.0", "0.0")
    assert second.returncode == 1 and "ABORTED" in second.stdout
    assert "RuntimeError: already" in system.output


@pytest.mark.slow
def test_exit_status_is_1_when_the_simulator_refuses_its_arguments(hosted):
    system = hosted("timer_driven", "scan_profile:=no_such")
    assert system.process.wait(DEADLINE) == 1, system.output
    assert "scan_profile" in system.output and system.processes() == []
