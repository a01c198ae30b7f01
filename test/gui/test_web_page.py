"""The web page in a real Chromium: it shows the system, and what is clicked there reaches the robot."""

import contextlib
import http.client
import math
import os
import socket

import pytest
from browser import Tab, chromium
from desktop import Recorder, Ros
from playwright.sync_api import Error as PlaywrightError
from waiting import DEADLINE, wait_for

from aro_robocop_goto_as.process.ports import free_port

pytestmark = [pytest.mark.xdist_group("web page"), pytest.mark.timeout(900)]

READY = r"stage_4[\s\S]*robocop_goto_as is ready"  # of simulator and bridge
REACHED = 0.15  # [m] from the goal: the server's tolerance and half the click's


class NoDesktop:
    """Stands in for a Desktop: the page needs none."""

    environment = dict(os.environ)

    def save_picture(self):
        """Nothing to save."""


class Web:
    """The lab without RViz, and robocop_web. Commands hold until the next one: nothing but the page stops the robot."""

    def __init__(self, directory, *arguments):
        self.ros = Ros(directory, NoDesktop(), "rviz:=false", "cmd_vel_timeout:=0", *arguments)
        self.port = free_port()
        self.url = f"http://localhost:{self.port}"

    def start(self, *arguments):
        """Start robocop_web; returns its process when it answers."""
        command = ("rosrun", "aro_robocop_goto_as", "robocop_web.py", f"web_port:={self.port}", *arguments)
        process = self.ros.start("web", *command)
        wait_for(self.answers, "robocop_web answers")
        return process

    def answers(self):
        """Whether its port accepts connections."""
        with socket.socket() as probe:
            return probe.connect_ex(("localhost", self.port)) == 0

    def status(self, **headers):
        """The status of the answer to an HTTP request; 101 = the page's WebSocket is opened."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=DEADLINE)
        try:
            connection.request("GET", "/", headers=headers)
            return connection.getresponse().status
        finally:
            connection.close()

    def position(self):
        """The robot's true x, y [m] in the world."""
        position = self.ros.latest("/ground_truth_odom")["pose"]["pose"]["position"]
        return position["x"], position["y"]

    def turn(self):
        """The robot's true angular velocity [rad/s]; the tests turn it on the spot, where no wall is in its way."""
        return self.ros.latest("/ground_truth_odom")["twist"]["twist"]["angular"]["z"]

    def sim(self):
        """The simulator's newest report."""
        return self.ros.latest("/robocop_sim/status")


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
    tab.wait_for_text(READY)
    yield tab
    tab.close()


def test_a_click_on_the_floor_drives_the_robot_there_and_the_page_reports_no_error(web, tab):
    results = Recorder(web.ros, "/aro_robocop_goto_as_node", "/robocop_goto_as/result")
    wait_for(results.connected, "recorder of results")
    tab.click_floor(0.0, 0.0)
    wait_for(results.messages, "a result")
    tab.wait_for_text("REACHED")
    assert math.hypot(*web.position()) < REACHED
    assert tab.errors == []
    assert tab.foreign == []


# Feedback is gone when the goal is reached, and a browser without a GPU may be too slow for text to be read until then.
RECORD_TEXT = """words => {
    window.recorded = "";
    const look = () => { if (document.body.innerText.includes(words)) window.recorded = words; };
    new MutationObserver(look).observe(document.body, {subtree: true, childList: true, characterData: true});
}"""
WEBSOCKET = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}


def test_only_requests_of_its_own_page_are_answered(web):
    ours, foreign = {"Host": f"localhost:{web.port}"}, {"Host": f"evil.example:{web.port}"}
    assert web.status(**ours) == 200
    assert web.status(**ours, **WEBSOCKET, Origin=web.url) == 101
    assert web.status(**ours, **WEBSOCKET, Origin="http://evil.example") == 403
    assert web.status(**foreign, **WEBSOCKET, Origin=f"http://evil.example:{web.port}") == 403
    assert web.status(**foreign) == 403


@pytest.mark.slow
def test_feedback_is_shown_while_a_goal_is_executed(web, tab):
    tab.page.evaluate(RECORD_TEXT, "position error")
    tab.click_floor(*((-0.5, 0.0) if web.position()[0] > -0.25 else (0.0, 0.0)))
    wait_for(lambda: tab.page.evaluate("window.recorded"), "feedback on the page")


@pytest.mark.slow
def test_the_robot_turns_while_a_button_is_held_and_stops_when_it_is_released(web, tab):
    with tab.held("Turn right (L)"):
        wait_for(lambda: web.turn() < -0.5, "the robot turns right")
    wait_for(lambda: abs(web.turn()) < 0.05, "the robot stands")


@pytest.mark.slow
def test_the_robot_turns_while_a_key_is_repeated_and_stops_when_it_is_released(web, tab):
    commands = Recorder(web.ros, "/robocop_web", "/cmd_vel")

    def repeated():
        tab.page.keyboard.down("j")
        return any(command["angular"]["z"] > 0.5 for command in commands.messages())

    wait_for(repeated, "the robot is told to turn left")
    tab.page.keyboard.up("j")
    wait_for(lambda: commands.messages()[-1]["angular"]["z"] == 0.0, "the robot is told to stop")
    wait_for(lambda: abs(web.turn()) < 0.05, "the robot stands")


@pytest.mark.slow
def test_the_robot_stops_when_the_page_that_drives_it_is_closed(web, browser):
    tab = Tab(browser, web.url)
    tab.wait_for_text(READY)
    with contextlib.suppress(PlaywrightError), tab.held("Turn right (L)"):
        wait_for(lambda: web.turn() < -0.5, "the robot turns right")
        tab.close()
        wait_for(lambda: abs(web.turn()) < 0.05, "the robot stands")


@pytest.mark.slow
def test_two_pages_show_the_same_state_and_a_reloaded_one_too(web, tab, browser):
    other = Tab(browser, web.url)
    other.wait_for_text(READY)
    tab.button("Pause").click()
    wait_for(lambda: web.sim()["paused"], "the simulator is paused")
    for page in (tab, other):
        page.wait_for_text("s, paused")
    other.page.reload()
    other.wait_for_text("s, paused")
    before = web.sim()["stamp"]
    other.button("Step").click()
    wait_for(lambda: web.sim()["stamp"] != before, "a step")
    other.button("Run").click()
    wait_for(lambda: not web.sim()["paused"], "the simulator runs")
    tab.wait_for_text("s, factor")
    other.close()


@pytest.mark.slow
def test_on_a_phone_nothing_is_wider_than_the_screen(web, browser):
    tab = Tab(browser, web.url, (390, 844))
    tab.wait_for_text("robocop")
    assert tab.page.evaluate("document.documentElement.scrollWidth") <= 390
    assert tab.errors == []
    tab.close()
