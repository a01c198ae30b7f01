"""Which nodes the launch files start for one robot and for many, with which names and frames; nothing is started."""
from pathlib import Path
from xml.etree import ElementTree

import pytest
import roslaunch.config

LAUNCH = Path(__file__).resolve().parents[2] / "launch"
LONE = {"/robocop_sim", "/robot_state_publisher", "/aro_robocop_goto_as_node", "/robocop_rviz_goto_ac_node", "/rviz"}
OF_EACH = ("robot_state_publisher", "aro_robocop_goto_as_node", "robocop_rviz_goto_ac_node")


class Launch:
    """What roslaunch makes of a file and its arguments."""

    def __init__(self, *arguments, file="robocop_goto_as.launch"):
        loaded = roslaunch.config.load_config_default(
            [(str(LAUNCH / file), list(arguments))], None, verbose=False, assign_machines=False)
        self.nodes = {node.namespace + node.name: node for node in loaded.nodes}
        self.params = {name: param.value for name, param in loaded.params.items()}

    def named(self, ending):
        """Parameters whose names end so."""
        return {name: value for name, value in self.params.items() if name.endswith(ending)}


def of_robots(*names):
    return {f"/{name}/{node}" for name in names for node in OF_EACH}


def test_lone_robot_has_no_namespace_and_no_prefix():
    launch = Launch()
    assert set(launch.nodes) == LONE
    assert launch.named("tf_prefix") == {}
    assert launch.named("/goal_frame") == {"/robocop_rviz_goto_ac_node/goal_frame": "odom"}
    assert launch.params["/robocop_sim/robots"] == ""
    assert "robocop.rviz -f map" in launch.nodes["/rviz"].args


@pytest.mark.parametrize("robots, names", [
    ("1", ["robot_1"]),
    ("3", ["robot_1", "robot_2", "robot_3"]),
    ("50", [f"robot_{i}" for i in range(1, 51)]),
    ("red 0 0", ["red"]),
    ("red 0 0.5; blue_2 1 -1 3.14", ["red", "blue_2"]),
])
def test_each_of_many_robots_has_its_nodes_in_its_namespace_and_its_frames(robots, names):
    launch = Launch(f"robots:={robots}", "rviz:=false")
    assert set(launch.nodes) == {"/robocop_sim"} | of_robots(*names)
    assert launch.params["/robocop_sim/robots"] == robots
    assert launch.named("tf_prefix") == {f"/{name}/robot_state_publisher/tf_prefix": name for name in names}
    assert launch.named("/goal_frame") == {
        f"/{name}/robocop_rviz_goto_ac_node/goal_frame": f"{name}/odom" for name in names}


def test_each_robot_has_the_description_of_its_own_model():
    def robots_described(*arguments):
        found = Launch(*arguments, "rviz:=false").named("robot_description")
        return {name: ElementTree.fromstring(text).get("name") for name, text in found.items()}

    assert robots_described() == {"/robot_description": "turtlebot3_burger"}
    assert robots_described("model:=waffle") == {"/robot_description": "turtlebot3_waffle"}
    assert robots_described("robots:=red 0 0; blue:waffle_pi 1 0", "model:=turtlebot2") == {
        "/red/robot_description": "turtlebot2", "/blue/robot_description": "turtlebot3_waffle_pi"}


def test_a_robots_model_is_no_part_of_its_name():
    launch = Launch("robots:=red:waffle 0 0; blue 1 0")
    assert set(launch.nodes) == {"/robocop_sim", "/red/rviz"} | of_robots("red", "blue")
    assert launch.params["/robocop_sim/robots"] == "red:waffle 0 0; blue 1 0"


def test_simulator_alone_publishes_the_state_of_each_robot():
    launch = Launch("robots:=2", file="robocop_sim.launch")
    assert set(launch.nodes) == {"/robocop_sim", "/robot_1/robot_state_publisher", "/robot_2/robot_state_publisher"}


def test_simulator_bridges_and_rviz_can_be_left_out():
    launch = Launch("robots:=2", "sim:=false", "bridge:=false", "rviz:=false")
    assert set(launch.nodes) == {f"/robot_{i}/aro_robocop_goto_as_node" for i in (1, 2)}


@pytest.mark.parametrize("arguments, node", [
    (["robots:=2"], "/robot_1/rviz"),
    (["robots:=red 0 0; blue 1 1"], "/red/rviz"),
    (["robots:=2", "rviz_robot:=robot_2"], "/robot_2/rviz"),
])
def test_rviz_of_many_robots_runs_in_the_namespace_of_the_one_it_shows(arguments, node):
    rviz = {name: it.args for name, it in Launch(*arguments).nodes.items() if name.endswith("rviz")}
    assert set(rviz) == {node}
    assert "many_robots.rviz -f map" in rviz[node]


def test_profile_wins_over_the_config_and_arguments_over_both():
    def timeout(*arguments):
        params = Launch(*arguments).params
        return params["/robocop_sim/cmd_vel_timeout"], params["/robocop_sim/scan_profile"]

    assert timeout() == (0.5, "gazebo")
    assert timeout("profile:=gazebo") == (0.0, "gazebo")
    assert timeout("profile:=real") == (-1.0, "lds01")
    assert timeout("profile:=real", "cmd_vel_timeout:=2", "scan_profile:=lds02") == (2.0, "lds02")


def test_time_and_drive_are_passed_on_to_the_simulator():
    launch = Launch("robots:=2", "drive:=kinematic", "sync:=lockstep", "real_time_factor:=0")
    found = [launch.params[f"/robocop_sim/{name}"] for name in ("drive", "sync", "real_time_factor")]
    assert found == ["kinematic", "lockstep", 0.0]
