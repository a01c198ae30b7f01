"""Names, namespaces and parameters of the nodes in the launch files, for one robot and for many; nothing is started."""

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest
import roslaunch.config
import roslaunch.xmlloader
import yaml

from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.param_loading import declared, from_dict
from aro_robocop_goto_as.ros.client.params import BridgeParams
from aro_robocop_goto_as.simulation.params import SimParams

ROOT = Path(__file__).resolve().parents[2]
LAUNCH = ROOT / "launch"
SIM, SERVER, BRIDGE = "/robocop_sim", "/aro_robocop_goto_as_node", "/robocop_rviz_goto_ac_node"
LONE = {"/robocop_sim", "/robocop_state_publisher", "/aro_robocop_goto_as_node", "/robocop_rviz_goto_ac_node", "/rviz"}
OF_EACH = ("robocop_state_publisher", "aro_robocop_goto_as_node", "robocop_rviz_goto_ac_node")


class Launch:
    """A launch file with arguments, as loaded by roslaunch."""

    def __init__(self, *arguments, file="robocop_goto_as.launch"):
        loaded = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader().load(str(LAUNCH / file), loaded, argv=list(arguments), verbose=False)
        self.nodes = {node.namespace + node.name: node for node in loaded.nodes}
        self.cleared = set(loaded.clear_params)
        self.params = {name: param.value for name, param in loaded.params.items()}

    def given(self, node):
        """Parameters that are set for a node."""
        return {name[len(node) + 1 :]: value for name, value in self.params.items() if name.startswith(node + "/")}

    def named(self, ending):
        """The parameters whose names end in this text."""
        return {name: value for name, value in self.params.items() if name.endswith(ending)}


def of_robots(*names):
    return {f"/{name}/{node}" for name in names for node in OF_EACH}


def test_single_robot_has_no_namespace_or_prefix():
    launch = Launch()
    assert set(launch.nodes) == LONE
    assert launch.named("tf_prefix") == {}
    assert from_dict(BridgeParams, launch.given(BRIDGE), BRIDGE).goal_frame == "odom"
    assert from_dict(SimParams, launch.given(SIM), SIM).robots.robots == ""
    assert launch.nodes["/rviz"].args == "--frame 'map' --config 'robocop.rviz'"


@pytest.mark.parametrize(
    "robots, names",
    [
        ("1", ["robot_1"]),
        ("3", ["robot_1", "robot_2", "robot_3"]),
        ("red 0 0", ["red"]),
        ("red 0 0.5; blue_2 1 -1 3.14", ["red", "blue_2"]),
        ("true 0 0", ["true"]),
        ("FALSE 0 0; True 1 1", ["FALSE", "True"]),
    ],
)
def test_each_of_many_robots_has_its_nodes_in_its_namespace_and_its_frames(robots, names):
    launch = Launch(f"robots:={robots}", "rviz:=false")
    assert set(launch.nodes) == {"/robocop_sim"} | of_robots(*names)
    assert launch.params["/robocop_sim/robots"] == robots
    assert launch.named("tf_prefix") == {f"/{name}/robocop_state_publisher/tf_prefix": name for name in names}
    assert launch.named("/goal_frame") == {
        f"/{name}/robocop_rviz_goto_ac_node/goal_frame": f"{name}/odom" for name in names
    }


def test_each_robot_has_the_description_of_its_own_model():
    def robots_described(*arguments):
        found = Launch(*arguments, "rviz:=false").named("robot_description")
        return {name: ElementTree.fromstring(text).get("name") for name, text in found.items()}

    assert robots_described() == {"/robot_description": "turtlebot3_burger"}
    assert robots_described("model:=waffle") == {"/robot_description": "turtlebot3_waffle"}
    assert robots_described("robots:=red 0 0; blue:waffle_pi 1 0", "model:=turtlebot2") == {
        "/robot_description": "turtlebot2",
        "/blue/robot_description": "turtlebot3_waffle_pi",
    }


@pytest.mark.parametrize("argument", ["model:=tank", "robots:=red:burger 0 0; blue:tank 1 0"])
def test_an_unknown_model_is_refused_with_the_models_that_there_are(capfd, argument):
    with pytest.raises(roslaunch.xmlloader.XmlParseException, match="robot_description"):
        Launch(argument)
    assert capfd.readouterr().err.startswith("ROBOT_MODEL: there is no model 'tank'; known are: burger, burger_rgbd, ")


def test_robots_in_a_configuration_are_answered_with_the_argument_that_starts_their_nodes(tmp_path, capfd):
    (tmp_path / "config.yaml").write_text("robots: 3 0\n")
    Launch(f"config:={tmp_path}/config.yaml")
    assert "`robots` is set in a file" in capfd.readouterr().err


def test_simulator_bridges_and_rviz_can_be_left_out():
    launch = Launch("robots:=2", "sim:=false", "bridge:=false", "rviz:=false")
    assert set(launch.nodes) == {f"/robot_{i}/aro_robocop_goto_as_node" for i in (1, 2)}


@pytest.mark.parametrize(
    "arguments, node",
    [
        (["robots:=2"], "/robot_1/rviz"),
        (["robots:=red 0 0; blue 1 1"], "/red/rviz"),
        (["robots:=2", "rviz_robot:=robot_2"], "/robot_2/rviz"),
    ],
)
def test_rviz_of_many_robots_runs_in_the_namespace_of_the_displayed_robot(arguments, node):
    rviz = {name: node.args for name, node in Launch(*arguments).nodes.items() if name.endswith("rviz")}
    assert set(rviz) == {node}
    assert rviz[node] == "--frame 'map' --config 'robots.rviz'"


def test_rviz_takes_a_frame_and_a_file_of_its_users():
    rviz = Launch("sim:=false", "rviz_frame:=odom", "rviz_config:=/home/me/my view.rviz").nodes["/rviz"]
    assert rviz.args == "--frame 'odom' --config '/home/me/my view.rviz'"


def arguments_of(file):
    return {arg.get("name") for arg in ElementTree.parse(LAUNCH / file).iter("arg")}


def layered(field, layer):
    """A value for a parameter that differs from its default and between two adjacent layers, 1 to 3."""
    special = {"robots": ["red 0 0", "2", "3"], "model": ["waffle", "waffle_pi", "turtlebot2"]}
    if field.name in special:
        return special[field.name][layer - 1]
    if isinstance(field.default, bool):
        return field.default ^ (layer % 2 == 1)
    if isinstance(field.default, str):
        return f"layer {layer}"
    return 1000 + layer if "int" in str(field.type) else layer / 8


def written(path, cls, layer):
    path.write_text(yaml.safe_dump({field.name: layered(field, layer) for field, _ in declared(cls).values()}))
    return path


@pytest.mark.parametrize("file", ["robocop_sim.launch", "robocop_goto_as.launch"])
def test_every_simulator_parameter_comes_from_argument_else_profile_else_config_else_its_default(tmp_path, file):
    def given(*arguments):
        return Launch(*arguments, file=file).given(SIM)

    def texts(layer, names):
        return [f"{field.name}:={layered(field, layer)}" for field in fields if field.name in names]

    fields = [field for field, _ in declared(SimParams).values()]
    values = [{field.name: layered(field, layer) for field in fields} for layer in (1, 2, 3)]
    arguments = arguments_of("robocop_sim.launch") & {field.name for field in fields}
    assert arguments
    config = f"config:={written(tmp_path / 'config.yaml', SimParams, 1)}"
    profiles = os.path.realpath(ROOT / "config" / "profiles")
    profile = f"profile:={os.path.relpath(written(tmp_path / 'profile.yaml', SimParams, 2), profiles)}"[: -len(".yaml")]

    assert given() == {}
    assert given(config) == values[0]
    assert given(config, profile) == values[1]
    assert given(*texts(3, arguments)) == {name: values[2][name] for name in arguments}
    assert given(config, profile, *texts(3, arguments)) == {
        **values[1],
        **{name: values[2][name] for name in arguments},
    }


def test_every_parameter_of_server_and_bridge_comes_from_argument_else_config_else_its_default(tmp_path):
    server = f"goto_config:={written(tmp_path / 'server.yaml', GotoParams, 1)}"
    bridge = f"bridge_config:={written(tmp_path / 'bridge.yaml', BridgeParams, 1)}"
    bare = Launch("sim:=false")
    assert bare.given(SERVER) == bare.given(BRIDGE) == {}
    launch = Launch("sim:=false", server, bridge)
    assert launch.given(SERVER) == yaml.safe_load((tmp_path / "server.yaml").read_text())
    values = yaml.safe_load((tmp_path / "bridge.yaml").read_text())
    assert launch.given(BRIDGE) == values
    launch = Launch("sim:=false", bridge, "ignore_goal_frame:=false")
    assert launch.given(BRIDGE) == {**values, "ignore_goal_frame": False}
    assert Launch("sim:=false", bridge, "robots:=red 0 0").given("/red" + BRIDGE) == values


def test_strings_that_look_like_numbers_or_booleans_stay_strings():
    sim = Launch("world:=7", "spawn:=0 0 0", "model:=burger", "scan_profile:=true", "robots:=1e3 0 0").given(SIM)
    assert sim == {"world": "7", "spawn": "0 0 0", "model": "burger", "scan_profile": "true", "robots": "1e3 0 0"}


def test_spawn_pose_can_be_given_as_to_turtlebot3_gazebo():
    def spawn(*arguments):
        return Launch(*arguments).given(SIM).get("spawn")

    assert spawn() is None
    assert spawn("x_pos:=-2.0", "y_pos:=-0.5") == "-2.0 -0.5 0"
    assert spawn("yaw:=1.57") == "0 0 1.57"
    assert spawn("x_pos:=1", "spawn:=3 4") == "3 4"


@pytest.mark.parametrize("file", ["robocop_sim.launch", "robocop_goto_as.launch"])
def test_model_comes_from_the_environment_as_for_turtlebot3_unless_it_is_given(monkeypatch, tmp_path, file):
    monkeypatch.setenv("TURTLEBOT3_MODEL", "waffle_pi")
    config = tmp_path / "config.yaml"
    config.write_text("model: waffle\nscan_angle_max: !degrees 90\n")  # a tag of rosparam

    def chosen(*arguments):
        launch = Launch(*arguments, file=file)
        (description,) = launch.named("robot_description").values()
        return launch.given(SIM)["model"], ElementTree.fromstring(description).get("name")

    assert chosen() == ("waffle_pi", "turtlebot3_waffle_pi")
    assert chosen(f"config:={config}") == ("waffle", "turtlebot3_waffle")
    assert chosen("model:=burger", f"config:={config}") == ("burger", "turtlebot3_burger")


def test_unknown_model_of_the_environment_is_refused_with_the_name_of_the_variable(monkeypatch, capfd):
    monkeypatch.setenv("TURTLEBOT3_MODEL", "wafle")
    with pytest.raises(roslaunch.xmlloader.XmlParseException, match="robot_description"):
        Launch()
    assert "TURTLEBOT3_MODEL" in capfd.readouterr().err
    assert Launch("model:=burger").given(SIM)["model"] == "burger"


@pytest.fixture(autouse=True)
def without_a_model_in_the_environment(monkeypatch):
    monkeypatch.delenv("TURTLEBOT3_MODEL", raising=False)


def test_parameters_of_an_earlier_launch_on_the_same_master_are_cleared():
    assert {"/robocop_sim", SERVER, BRIDGE} <= {name.rstrip("/") for name in Launch().cleared}
    assert {"/red" + SERVER, "/red" + BRIDGE} <= {name.rstrip("/") for name in Launch("robots:=red 0 0").cleared}


def test_rviz_shows_the_same_of_robots_with_names_without_a_model_and_without_a_frame_that_they_do_not_have():
    lab, robots = (yaml.safe_load((ROOT / "rviz" / f"{name}.rviz").read_text()) for name in ("robocop", "robots"))
    displays = lab["Visualization Manager"]["Displays"]
    displays[:] = [entry for entry in displays if entry["Name"] not in ("Robot", "Frame odom")]
    assert robots == lab
