"""./robocop record and replay: what was recorded of a run is published again, with its clock."""

import os
import signal
import sys
from pathlib import Path

import pytest
import rosbag
from systems import System
from waiting import wait_for

from robocop_hosting.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
RESULT = "/robocop_goto_as/result"
SERVER = "/aro_robocop_goto_as_node"
LISTENER = """
import rospy
from aro_robocop_goto_as.msg import GoToPositionActionResult
rospy.init_node("listener")
print(rospy.wait_for_message("/robocop_goto_as/result", GoToPositionActionResult).result.message)
"""


@pytest.fixture
def ros(tmp_path):
    with System(tmp_path, {**os.environ, "DISPLAY": ""}) as system:
        yield system


@pytest.mark.slow
def test_a_recorded_goal_is_played_again(ros, tmp_path):
    def robocop(command, *arguments):
        return ros.start(command, ROOT / "robocop", command, *arguments, cwd=folder)

    folder = tmp_path / "folder"
    folder.mkdir()
    system = robocop("run", "rviz:=false", "real_time_factor:=5")
    wait_for(lambda: ros.publisher(RESULT, SERVER), "the server")
    recorder = robocop("record", "run.bag")
    wait_for((folder / "run.bag.active").exists, "the bag")
    wait_for(lambda: ros.linked(SERVER, ros.subscriber(RESULT, "/record_") or "", RESULT), "the recorder gets results")
    assert robocop("goto", "-0.5", "0").wait_for_exit() == 0
    recorder.end(signal.SIGINT)
    system.end(signal.SIGINT)
    with rosbag.Bag(folder / "run.bag") as bag:
        topics = bag.get_type_and_topic_info().topics
        assert {"/clock", "/scan", "/odom", "/tf_static", "/robocop_sim/world"} <= set(topics)
        assert topics["/robocop_goto_as/result"].message_count == 1

    wait_for(lambda: not ros.master.is_online(), "the end of the system")
    ros.start_master()
    listener = ros.start("listener", sys.executable, "-c", LISTENER)  # before the replay, or it could miss the result
    wait_for(lambda: ros.subscriber(RESULT, "/listener"), "the listener")
    replay = robocop("replay", "run.bag", "rate:=5", "waits:=false", f"web_port:={free_port()}")
    wait_for(lambda: "REACHED" in listener.output, "the recorded result")
    assert replay.end(signal.SIGINT) == 0
