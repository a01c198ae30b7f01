"""The web page in a real Chromium: it shows the system, and what is clicked there reaches the robot."""

import http.client
import math
import os
import socket

import pytest
from browser import Tab, chromium
from desktop import Recorder, Ros, wait_for

from aro_robocop_goto_as.process.ports import free_port

pytestmark = [pytest.mark.xdist_group("web page"), pytest.mark.timeout(900)]

REACHED = 0.15  # [m] from the goal: the server's tolerance and half the click's


class NoDesktop:
    """Stands in for a Desktop: the page needs none."""

    environment = dict(os.environ)

    def save_picture(self):
        """Nothing to save."""


class Web:
    """The lab without RViz, and robocop_web."""

    def __init__(self, directory, *arguments):
        self.ros = Ros(directory, NoDesktop(), "rviz:=false", *arguments)
        self.port = free_port()
        self.url = f"http://localhost:{self.port}"
        self.process = None

    def start(self, *arguments):
        """Start robocop_web; returns when it answers."""
        command = ("rosrun", "aro_robocop_goto_as", "robocop_web.py", f"web_port:={self.port}", *arguments)
        self.process = self.ros.start("web", *command)
        wait_for(self.answers, "robocop_web answers")

    def answers(self):
        """Whether its port accepts connections."""
        with socket.socket() as probe:
            return probe.connect_ex(("localhost", self.port)) == 0

    def status(self, path="/", **headers):
        """The status of the answer to an HTTP request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60.0)
        try:
            connection.request("GET", path, headers=headers)
            return connection.getresponse().status
        finally:
            connection.close()

    def pose(self):
        """The robot's true x, y [m] and heading [rad] in the world."""
        pose = self.ros.latest("/ground_truth_odom")["pose"]["pose"]
        return (
            pose["position"]["x"],
            pose["position"]["y"],
            2.0 * math.atan2(pose["orientation"]["z"], pose["orientation"]["w"]),
        )

    def velocity(self):
        """The robot's true speed [m/s]."""
        return self.ros.latest("/ground_truth_odom")["twist"]["twist"]["linear"]["x"]


@pytest.fixture(scope="module")
def web(tmp_path_factory):
    web = Web(tmp_path_factory.mktemp("web"))
    with web.ros:
        web.start()
        yield web


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@pytest.fixture
def tab(web, browser):
    tab = Tab(browser, web.url)
    tab.wait_for_text(r"stage_4[\s\S]*robocop_goto_as is ready|robocop_goto_as[\s\S]*stage_4")
    yield tab
    tab.close()


def test_a_click_on_the_floor_drives_the_robot_there_and_the_page_reports_no_error(web, tab):
    results = Recorder(web.ros, "/aro_robocop_goto_as_node", "/robocop_goto_as/result")
    wait_for(results.connected, "recorder of results")
    tab.click_floor(0.0, 0.0)
    tab.wait_for_text("position error")
    wait_for(results.messages, "a result")
    tab.wait_for_text("REACHED")
    assert math.hypot(*web.pose()[:2]) < REACHED
    assert tab.errors == []
    assert tab.foreign == []
