"""What a node has sent before it ends is handled, however slowly, before it counts as heard no more."""

import os
import subprocess
import sys

from waiting import DEADLINE

from aro_robocop_goto_as.process.ports import free_port
from robocop_grading.session.own_master import start_master

MESSAGES = 50
PUBLISHER = f"""
import os, rospy
from std_msgs.msg import Int32
rospy.topics.QueuedConnection = lambda connection, _size: connection  # sent when publish() returns, as by the agent
rospy.init_node("publisher", disable_rosout=True)
topic = rospy.Publisher("count", Int32, queue_size=0)
while not topic.get_num_connections():
    rospy.sleep(0.01)
for number in range({MESSAGES}):
    topic.publish(number)
os._exit(0)
"""
LISTENER = f"""
import subprocess, sys, threading, time, rospy
from std_msgs.msg import Int32
from robocop_grading.session import ros_internals
ros_internals.install()
handled, ended = [], threading.Event()
rospy.init_node("listener", disable_rosout=True)
rospy.Subscriber("count", Int32, lambda message: (ended.wait(), handled.append(message.data)))
own = rospy.Publisher("own", Int32, queue_size=0)
rospy.Subscriber("own", Int32, lambda message: None)  # this process's own topic never ends
publisher = subprocess.Popen([sys.executable, "-c", {PUBLISHER!r}])
assert publisher.wait() == 0
assert ros_internals.hears_from("/publisher")
ended.set()
while ros_internals.hears_from("/publisher"):
    time.sleep(0.001)
print(len(handled), own.get_num_connections())
"""


def test_the_messages_of_a_node_that_has_ended_are_all_handled_before_it_is_heard_no_more():
    port = free_port()
    master = start_master(port)
    try:
        environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{port}"}
        command = [sys.executable, "-c", LISTENER]
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True, timeout=DEADLINE)
        assert done.stdout.split() == [str(MESSAGES).encode(), b"1"]
    finally:
        master.shutdown("the test is over")
