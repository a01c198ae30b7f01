"""./robocop record and replay: what was recorded of a run is published again, with its clock."""

import os
import signal
import subprocess
import sys
import xmlrpc.client
from pathlib import Path

import pytest
import rosbag
import rosgraph
from waiting import wait_for

from aro_robocop_goto_as.process.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
SERVER = "/aro_robocop_goto_as_node"
LISTENER = """
import rospy
from aro_robocop_goto_as.msg import GoToPositionActionResult
rospy.init_node("listener")
print(rospy.wait_for_message("/robocop_goto_as/result", GoToPositionActionResult).result.message)
"""


class Commands:
    """Runs ./robocop on a master of its own; `start` ends with the test."""

    def __init__(self, folder):
        self.folder = folder
        self.uri = f"http://localhost:{free_port()}"
        self.master = rosgraph.Master("/record_test", self.uri)
        self.environment = {**os.environ, "ROS_MASTER_URI": self.uri, "ROS_HOSTNAME": "localhost", "DISPLAY": ""}
        self.running = []

    def start(self, *command):
        process = subprocess.Popen([ROOT / "robocop", *command], cwd=self.folder, env=self.environment)
        self.running.append(process)
        return process

    def run(self, *command):
        """Another program on that master, with its output in a pipe."""
        process = subprocess.Popen(command, env=self.environment, stdout=subprocess.PIPE, text=True)
        self.running.append(process)
        return process

    def subscribes(self, topic, node):
        """Whether a node subscribes to a topic."""
        return node in dict(self.master.getSystemState()[1]).get(topic, [])

    def sends(self, topic, node, receiver):
        """Whether a node in Python sends a topic to one whose name begins so."""
        publisher = xmlrpc.client.ServerProxy(self.master.lookupNode(node))
        links = publisher.getBusInfo("/record_test")[2]
        return any(link[1].startswith(receiver) and link[2] == "o" and link[4] == topic for link in links)

    def publishes(self, topic, node):
        """Whether a node publishes a topic."""
        if not self.master.is_online():
            return False
        publishers = dict(self.master.getSystemState()[0])
        return node in publishers.get(topic, [])

    def end(self, process):
        """Interrupt a process; its exit status."""
        process.send_signal(signal.SIGINT)
        return process.wait(60.0)


@pytest.fixture
def robocop(tmp_path):
    commands = Commands(tmp_path)
    yield commands
    for process in reversed(commands.running):
        if process.poll() is None:
            commands.end(process)


@pytest.mark.slow
def test_a_recorded_goal_is_played_again(robocop):
    system = robocop.start("run", "rviz:=false", "real_time_factor:=5")
    wait_for(lambda: robocop.publishes("/robocop_goto_as/result", SERVER), "the server")
    recorder = robocop.start("record", "run.bag")
    wait_for((robocop.folder / "run.bag.active").exists, "the bag")
    wait_for(lambda: robocop.sends("/robocop_goto_as/result", SERVER, "/record_"), "the recorder gets results")
    assert robocop.start("goto", "-0.5", "0").wait(60.0) == 0
    robocop.end(recorder)
    robocop.end(system)
    with rosbag.Bag(robocop.folder / "run.bag") as bag:
        topics = bag.get_type_and_topic_info().topics
        assert {"/clock", "/scan", "/odom", "/tf_static", "/robocop_sim/world"} <= set(topics)
        assert topics["/robocop_goto_as/result"].message_count == 1

    wait_for(lambda: not robocop.master.is_online(), "the end of the system")
    robocop.run("rosmaster", "--core", "-p", robocop.uri.rpartition(":")[2])
    wait_for(robocop.master.is_online, "a master")
    listener = robocop.run(sys.executable, "-c", LISTENER)  # before the replay, or it could miss the result
    wait_for(lambda: robocop.subscribes("/robocop_goto_as/result", "/listener"), "the listener")
    replay = robocop.start("replay", "run.bag", "rate:=5", "waits:=false", f"web_port:={free_port()}")
    assert "REACHED" in listener.communicate(timeout=120)[0]
    assert robocop.end(replay) == 0


def test_recording_never_overwrites_a_bag(robocop):
    (robocop.folder / "run.bag").write_text("precious")
    assert robocop.start("record", "run").wait(60.0) == 1
    assert (robocop.folder / "run.bag").read_text() == "precious"


def test_recording_without_a_running_system_is_refused_with_what_to_do(robocop, capfd):
    assert robocop.start("record", "run").wait(60.0) == 1
    assert "no ROS system is running; start ./robocop run" in capfd.readouterr().err
    assert list(robocop.folder.iterdir()) == []
