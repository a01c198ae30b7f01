"""The web page in a real Chromium when parts of the system are killed: it goes on, or ends with its master."""

import math
import os
import signal
import xmlrpc.client

import pytest
from browser import Tab
from desktop import Master
from systems import CALLER
from waiting import DEADLINE, wait_for
from web import REACHED, READY, Web

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("web page"), pytest.mark.timeout(900)]

PACKAGE = "aro_robocop_goto_as"
SIMULATOR, SERVER = "/robocop_sim", "/aro_robocop_goto_as_node"
SILENT = "No report from the simulator"


class Parts(Web):
    """As Web, but master, simulator and server are started one by one."""

    system = Master

    def start_simulator(self):
        """Start the simulator."""
        self.ros.start("sim", "roslaunch", PACKAGE, "robocop_sim.launch", "cmd_vel_timeout:=0")

    def start_server(self, bridge=True):
        """Start the server, with or without the bridge."""
        file = "robocop_goto_as.launch"
        self.ros.start("server", "roslaunch", PACKAGE, file, "sim:=false", "rviz:=false", f"bridge:={bridge}")

    def kill(self, name):
        """Kill a node."""
        with xmlrpc.client.ServerProxy(self.ros.master.lookupNode(name)) as node:
            os.kill(node.getPid(CALLER)[2], signal.SIGKILL)


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    parts = Parts(tmp_path_factory.mktemp("parts"))
    with parts.ros:
        parts.start_simulator()
        parts.start_server()
        parts.page = parts.start()
        yield parts


@pytest.fixture
def tab(parts, browser):
    tab = Tab(browser, parts.url)
    tab.wait_for_text(READY)
    yield tab
    tab.close()


def expect_a_click_to_drive_the_robot(web, tab):
    goal = (-0.5, 0.0) if web.position()[0] > -0.25 else (0.0, 0.0)
    tab.click_floor(*goal)
    wait_for(lambda: math.dist(web.position(), goal) < REACHED, f"the robot has driven to {goal}; {tab.text()}")


def test_the_page_reports_a_killed_simulator_and_shows_the_next_one(parts, tab):
    parts.kill(SIMULATOR)
    tab.wait_for_text(SILENT)
    parts.start_simulator()
    wait_for(lambda: SILENT not in tab.text(), "the page has a report from the simulator")
    tab.wait_for_text("server.*(lost|not|no |waiting)")  # simulated time has begun again, which ends a server
    parts.start_server(bridge=False)
    tab.wait_for_text(READY)
    expect_a_click_to_drive_the_robot(parts, tab)


def test_the_browser_connects_again_by_itself_when_the_page_is_killed_and_started_again(parts, tab):
    parts.page.kill()
    parts.page.wait()
    wait_for(lambda: "Connected" not in tab.text(), "the browser has noticed; until then it shows what it had")
    sockets = tab.sockets
    parts.page = parts.start()
    wait_for(lambda: tab.page.evaluate("1") and tab.sockets > sockets, "the browser connects again")
    tab.wait_for_text(rf"Connected[\s\S]*{READY}")
    expect_a_click_to_drive_the_robot(parts, tab)


def test_the_page_ends_with_its_master(parts):
    os.kill(parts.ros.master.getPid(), signal.SIGKILL)
    assert parts.page.wait(DEADLINE) == 0
