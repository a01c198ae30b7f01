"""A package as students write them runs unchanged with this simulator."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from systems import Program, System, is_running

from robocop_grading import new
from robocop_hosting.workspace import compat_folder, places

NODES = Path(__file__).resolve().parent / "nodes"
SOLUTIONS = Path(__file__).resolve().parents[1] / "solutions"
# Its habits that the simulator must tolerate: it depends on Gazebo's types and waits for Gazebo's services.
LIGHT_OFF = """from gazebo_msgs.srv import DeleteLight
        rospy.wait_for_service('/gazebo/delete_light')
        rospy.ServiceProxy('/gazebo/delete_light', DeleteLight)('sun')
"""
CHANGES = {
    "package.xml": (
        "<depend>rospy</depend>",
        "<depend>rospy</depend><depend>gazebo_msgs</depend><depend>ros_numpy</depend>",
    ),
    "CMakeLists.txt": ("COMPONENTS ", "COMPONENTS gazebo_msgs ros_numpy "),
    "scripts/robocop_goto_as.py": ("self.pose = None\n", f"{LIGHT_OFF}        self.pose = None\n"),
}
DEADLINE = 300.0  # [s, wall] for a build and a start on a busy machine
pytestmark = [
    pytest.mark.slow,
    pytest.mark.xdist_group("hosting"),  # the first test builds the workspace that all of them extend
    pytest.mark.timeout(900),  # several times DEADLINE
]


class Hosted(Program):
    """`robocop sim --with PACKAGE` on a master of its own."""

    deadline = DEADLINE

    def __init__(self, package, folder, *arguments):
        super().__init__(folder, "robocop_sim_with.py", package, "world:=empty", *arguments, ROBOCOP_RVIZ="false")

    def call(self, *command, **environment):
        return subprocess.run(
            command,
            env={**self.environment, **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=DEADLINE,
        )

    def end(self):
        """Interrupt it as by Ctrl-C; the processes that are left."""
        self.process.interrupt()
        self.process.wait(DEADLINE)
        return self.processes()


def contents(package):
    """Content and mode of every file."""
    return {path: (path.read_bytes(), path.stat().st_mode) for path in package.rglob("*") if path.is_file()}


def as_taught(folder):
    """A package that somebody has made with `robocop new` and filled in."""
    package = folder / "as_taught"
    new.make(package)
    for script, solution in (("robocop_goto_as.py", "base_server"), ("robocop_rviz_goto_ac.py", "base_bridge")):
        (package / "scripts" / script).write_text((SOLUTIONS / f"{solution}.py.in").read_text())
    for file, change in CHANGES.items():
        (package / file).write_text((package / file).read_text().replace(*change))
    return package


def test_a_package_in_the_style_of_the_lab_is_built_and_reaches_a_goal_with_gazebos_services(tmp_path):
    package = as_taught(tmp_path)
    before = contents(package)
    with Hosted(package, tmp_path) as system:
        system.wait_until(lambda: "server: " in system.output, "its bridge talks to its server")
        done = system.call("rosrun", "aro_robocop_goto_as", "robocop_goto.py", "0.3", "0.3")
        assert (done.returncode, "SUCCEEDED: finished successfully" in done.stdout) == (0, True), (
            done.stdout + system.output
        )
        assert "PARAMETERS" not in system.output
        assert "world         empty\nrobot         burger\ntransforms    none from odom to the robot" in system.output
        state, share = places()
        types = compat_folder(share, state) / "devel" / "lib" / "python3" / "dist-packages"
        output = system.call(
            sys.executable, str(NODES / "gazebo_calls.py"), PYTHONPATH=f"{os.environ['PYTHONPATH']}:{types}"
        ).stdout
        assert system.end() == []
    expect_gazebos_answers(json.loads(output.splitlines()[-1]))
    with Hosted(package, tmp_path, "scan_profile:=no_such") as refused:
        assert refused.process.wait(DEADLINE) == 1, refused.output
        assert "scan_profile" in refused.output and refused.processes() == []
    assert contents(package) == before, "its author's files were changed"


def expect_gazebos_answers(answers):
    """The answers to gazebo_calls.py are those of Gazebo."""
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
        "set": True,
        "paused": True,
        "moved by itself": True,
        "time": True,
    }


MANIFEST = """<package format="2"><name>{}</name><version>0.0.1</version><description>d</description>
<maintainer email="a@example.com">m</maintainer><license>BSD</license><buildtool_depend>catkin</buildtool_depend>{}
</package>"""
WORKSPACE = {
    "drive/package.xml": MANIFEST.format("drive", "<depend>rospy</depend>"),  # which does not name drive_msgs
    "drive/CMakeLists.txt": "cmake_minimum_required(VERSION 3.10)\nproject(drive)\n"
    "find_package(catkin REQUIRED)\ncatkin_package()\n"
    "catkin_install_python(PROGRAMS scripts/drive.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})\n",
    "drive/launch/drive.launch": '<launch><node pkg="drive" type="drive.py" name="drive"/>'
    '<param name="model" command="$(find xacro)/xacro $(dirname)/model.xacro"/>\n'
    '<node pkg="tf" type="static_transform_publisher" name="gripper" args="0 0 0 0 0 0 base_link gripper 100"/>\n'
    '<node pkg="no_such_package" type="a" name="b"/></launch>\n',
    "drive/scripts/drive.py": "#!/usr/bin/env python3\nfrom drive_msgs.msg import Side\nraise ValueError(Side(1.5))\n",
    "drive/launch/model.xacro": '<a xmlns:xacro="http://ros.org/wiki/xacro"><xacro:property name="b" value="1"/></a>',
    "count/package.xml": MANIFEST.format("count", "<depend>roscpp</depend>"),
    "count/CMakeLists.txt": "cmake_minimum_required(VERSION 3.10)\nproject(count)\n"
    "find_package(catkin REQUIRED COMPONENTS roscpp)\ncatkin_package()\ninclude_directories(${catkin_INCLUDE_DIRS})\n"
    "add_library(count count.cpp)\n",
    "count/count.cpp": "#include <ros/ros.h>\nint twice(int n) { return 2 * n; }\n"
    "int count() { return boost::bind(&twice, _1)(1); }  // as ROS' tutorials write it\n",
    "drive_msgs/package.xml": MANIFEST.format("drive_msgs", "<depend>std_msgs</depend>"),
    "drive_msgs/CMakeLists.txt": "cmake_minimum_required(VERSION 3.10)\nproject(drive_msgs)\n"
    "find_package(catkin REQUIRED COMPONENTS message_generation std_msgs)\nadd_message_files(FILES Side.msg)\n"
    "generate_messages(DEPENDENCIES std_msgs)\ncatkin_package()\n",
    "drive_msgs/msg/Side.msg": "float32 length\n",
}


def test_node_with_its_neighbours_messages_ends_and_is_named_beside_the_overview(tmp_path):
    for name, text in WORKSPACE.items():
        (tmp_path / "ws" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "ws" / name).write_text(text)
    script = tmp_path / "ws" / "drive" / "scripts" / "drive.py"
    script.chmod(0o755)
    with Hosted(tmp_path / "ws", tmp_path) as system:
        words = ("[drive-3] process has died", "all messages  appear below\n")
        system.wait_until(lambda: all(word in system.output for word in words), "node and overview")
        assert is_running(system.uri, "/gripper"), system.output
        above = system.output.partition(words[1])[0]
        assert f'File "{script}", line 3' in system.output
        assert "cannot launch node of type [no_such_package/a]" in above
        setup = re.search(r"source \S+/setup.bash --extend", above)[0]
        done = system.call("bash", "-c", f"{setup} && rosmsg show drive_msgs/Side && rospack find drive")
        assert done.stdout == f"float32 length\n\n{script.parents[1]}\n"
        done = system.call("rosrun", "aro_robocop_goto_as", "robocop_goto.py", "0.3", "0.3")
        assert "the terminal of its system says why" in done.stdout and "rosrun" not in done.stdout, done.stdout
        system.end()


def test_commands_of_a_turtlebot_2_drive_its_model(tmp_path):
    with System(tmp_path) as system:
        system.start_master()
        arguments = ("_model:=turtlebot2", "_world:=empty", "_drive:=kinematic")
        simulator = system.start("sim", "rosrun", "aro_robocop_goto_as", "robocop_sim.py", *arguments)
        twist = ("geometry_msgs/Twist", "{linear: {x: 0.2}}")
        system.start("driver", "rostopic", "pub", "-r", "10", "/cmd_vel_mux/input/navi", *twist)
        system.wait(lambda: system.latest("/odom")["pose"]["pose"]["position"]["x"] > 0.05, "it drives", simulator)
