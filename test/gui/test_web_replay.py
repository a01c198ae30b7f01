"""./robocop replay in a real Chromium: a recording of a robot that drives straight ahead, with its pause."""

import socket

import pytest
import rosbag
import rospy
from actionlib_msgs.msg import GoalStatus
from aro_robocop_goto_as.msg import GoToPositionActionResult
from browser import Tab
from desktop import Ros
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage
from waiting import wait_for
from web import NoDesktop

from robocop_hosting.ports import free_port

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("web page"), pytest.mark.timeout(600)]

DURATION, RATE, SPEED = 60.0, 20, 0.1  # [s], [Hz], [m/s]
BEGIN = 54.0  # [s] after the beginning, from where on it is played
START = 1_700_000_000.0  # [s]


def write_bag(path):
    """A robot that drives along x, and a goal that is reached at the end."""
    with rosbag.Bag(path, "w") as bag:
        for tick in range(int(DURATION * RATE) + 1):
            stamp, x = rospy.Time.from_sec(START + tick / RATE), SPEED * tick / RATE
            odometry, transform = Odometry(child_frame_id="base_footprint"), TransformStamped()
            odometry.header.frame_id = transform.header.frame_id = "odom"
            odometry.header.stamp = transform.header.stamp = stamp
            odometry.pose.pose.position.x = transform.transform.translation.x = x
            odometry.pose.pose.orientation.w = transform.transform.rotation.w = 1.0
            transform.child_frame_id = "base_footprint"
            bag.write("/odom", odometry, stamp)
            bag.write("/tf", TFMessage([transform]), stamp)
        result = GoToPositionActionResult()
        result.status.goal_id.id, result.status.status = "goal", GoalStatus.SUCCEEDED
        result.result.success, result.result.message = True, "REACHED: recorded"
        bag.write("/robocop_goto_as/result", result, stamp)


def is_free(port):
    with socket.socket() as probe:
        return probe.connect_ex(("localhost", port)) != 0


class Replay(Ros):
    """The launch file of ./robocop replay."""

    def command(self):
        """What starts the master."""
        return ["roslaunch", "-p", self.port, "aro_robocop_goto_as", "replay.launch", "rviz:=false", *self.arguments]


def test_a_recording_is_played_from_a_moment_paused_and_ends_with_its_goal(tmp_path, browser):
    write_bag(tmp_path / "server-drive.bag")
    port = free_port()
    arguments = [f"bag:={tmp_path / 'server-drive.bag'}", f"web_port:={port}", "rate:=0.15", f"start:={BEGIN}"]
    with Replay(tmp_path, NoDesktop(), *arguments) as ros:
        wait_for(lambda: not is_free(port), "the page is served")
        tab = Tab(browser, f"http://localhost:{port}")
        tab.wait_for_text("recorded time")

        def x():
            return ros.latest("/odom")["pose"]["pose"]["position"]["x"]  # which a newcomer gets from one second before

        wait_for(lambda: x() >= BEGIN * SPEED, "it begins at the moment that was asked for, with the first browser")
        tab.click("Pause")
        wait_for(lambda: ros.latest("/clock") == ros.latest("/clock"), "the recorded clock stands")
        assert "REACHED" not in tab.text(), "it stands before its end"
        assert not tab.button("Cancel goal").is_visible()
        tab.click("Play")
        tab.wait_for_text("REACHED: recorded")
        assert tab.errors == []
