"""A node that was about to register with a master that has been killed ends at once on SIGTERM."""

import os
import signal
import subprocess
import sys

import rosgraph
from waiting import wait_for

from aro_robocop_goto_as.process.ports import free_port

NODE = """
import rospy, std_msgs.msg
from aro_robocop_goto_as.ros.node_main import node
with node("alone"):
    rospy.Publisher("first", std_msgs.msg.Empty, queue_size=1)
    print("ready", flush=True)
    input()
    rospy.Publisher("second", std_msgs.msg.Empty, queue_size=1)
"""


def test_node_ends_on_a_signal_while_its_master_is_gone(tmp_path):
    port = free_port()
    uri = f"http://localhost:{port}"
    environment = {**os.environ, "ROS_MASTER_URI": uri, "ROS_HOSTNAME": "localhost", "ROS_HOME": str(tmp_path)}
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], env=environment)
    wait_for(rosgraph.Master("/test", uri).is_online, "the master answers")
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    node = subprocess.Popen([sys.executable, "-uc", NODE], env=environment, **pipes)
    try:
        assert node.stdout.readline() == "ready\n"
        master.kill()
        master.wait()
        node.stdin.write("\n")
        node.stdin.flush()
        assert "Unable to register" in node.stdout.readline()
        node.send_signal(signal.SIGTERM)
        assert node.wait(60.0) == 0
    finally:
        for process in (master, node):
            process.kill()
            process.wait()
        node.stdin.close()
        node.stdout.close()
