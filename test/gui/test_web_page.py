"""The web page in a real Chromium: it shows the system, and what is clicked there reaches the robot."""

import contextlib
import math

import numpy as np
import pytest
from actionlib_msgs.msg import GoalStatus
from browser import Tab
from desktop import Recorder
from playwright.sync_api import Error as PlaywrightError
from waiting import wait_for
from web import REACHED, READY, Web

from aro_robocop_goto_as.ros.web.plots import HEIGHT as PLOT
from aro_robocop_goto_as.web.page import corners_of

pytestmark = [pytest.mark.xdist_group("web page"), pytest.mark.timeout(900)]

SPAWN = (-0.7, 0.0)  # [m] where the robot starts in stage_4
CLICK = 0.05  # [m] error of a click on the floor, a few pixels


@pytest.fixture(scope="module")
def web(tmp_path_factory):
    web = Web(tmp_path_factory.mktemp("web"))
    with web.ros:
        web.start()
        yield web


@pytest.fixture
def tab(web, browser):
    tab = Tab(browser, web.url)
    tab.wait_for_text(READY)
    yield tab
    tab.close()


def test_a_click_on_the_floor_drives_the_robot_there_and_the_page_reports_no_error(web, tab):
    results = Recorder(web.ros, "/aro_robocop_goto_as_node", "/robocop_goto_as/result")
    wait_for(results.connected, "recorder of results")

    def places():
        return [tab.button(label).bounding_box() for label in ("Cancel goal", "Reset")]

    before = places()
    tab.click_floor(0.0, 0.0)
    wait_for(results.messages, "a result")
    tab.wait_for_text(r"goal\s+SUCCEEDED \(-?0\.0\d, -?0\.0\d\)[\s\S]*REACHED: 0\.\d+ m from the goal")
    assert math.hypot(*web.position()) < REACHED
    wait_for(tab.button("Cancel goal").is_disabled, "there is nothing to cancel")
    assert places() == before, "the buttons stay where they are"
    assert tab.page.get_by_text("The lab, step by step").get_attribute("href") == "/lab.md"
    assert web.status("/lab.md") == 200
    assert tab.errors == []
    assert tab.foreign == []


UPRIGHT, TURNED, DENSITY = (393, 727), (802, 293), 2.75  # sizes [pixel] of a Pixel 5's browser window


@pytest.mark.slow
def test_the_room_fills_the_scene_of_a_phone_however_it_is_turned(web, browser):
    clicks = Recorder(web.ros, "/robocop_web", "/move_base_simple/goal")
    web.place(*SPAWN)
    tab = Tab(browser, web.url, UPRIGHT, touch=True, density=DENSITY)
    tab.wait_for_text(READY)
    tab.page.locator(".mantine-Notification-closeButton").click(force=True)  # of viser's warning of a slow browser

    def sent():
        positions = (message["pose"]["position"] for message in clicks.messages())
        return [(position["x"], position["y"]) for position in positions]

    def a_tap_hits(place):
        tab.tap(*tab.pixel(*place))
        return sent() and math.dist(sent()[-1], place) < CLICK

    for size, place in ((UPRIGHT, (-0.5, 0.0)), (TURNED, (-0.5, 0.2)), (UPRIGHT, (-0.5, 0.0))):
        tab.turn(size)
        wait_for(lambda at=place: a_tap_hits(at), "the view fits the size")
        corners = tab.pixels(corners_of(()))
        assert tab.covered(corners) == []
        assert max(np.ptp(corners, axis=0) / tab.scene()) > 0.9
    assert tab.errors == []
    tab.close()


BUTTON_AT = "([x, y]) => document.elementFromPoint(x, y)?.closest('button')?.innerText.trim()"
KEY_OF = "button => getComputedStyle(button.querySelector('.mantine-Button-label'), '::after').content"


@pytest.mark.slow
def test_on_a_phone_the_buttons_that_drive_are_in_reach_and_as_large_as_a_finger_and_name_no_keys(web, browser):
    tab = Tab(browser, web.url, UPRIGHT, touch=True)
    tab.wait_for_text(READY)
    wait_for(lambda: not tab.button("Forward").is_visible(), "they are folded, and do not cover the tabs")
    tab.page.get_by_text("Drive", exact=True).tap()

    def is_in_reach(label, height):
        box = tab.button(label).bounding_box()  # None while the panel is laid out anew
        if box is None or box["height"] < 44.0 or box["y"] + box["height"] > height:
            return False
        return tab.page.evaluate(BUTTON_AT, (box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0)) == label

    for size in (UPRIGHT, TURNED):
        tab.turn(size)
        for label in ("Stop", "Forward", "Left", "Back", "Right"):
            wait_for(lambda of=(label, size[1]): is_in_reach(*of), f"{label} is in reach at {size}")
            assert tab.button(label).evaluate(KEY_OF) == "none"
    tab.close()


@pytest.mark.slow
def test_a_tab_that_is_chosen_on_a_phone_fills_the_panel(web, browser):
    tab = Tab(browser, web.url, UPRIGHT, touch=True)
    tab.wait_for_text(READY)
    tab.page.get_by_role("tab", name="Plots").dispatch_event("click")
    title = tab.page.get_by_role("tabpanel").get_by_text("errors", exact=True)
    drive = tab.page.get_by_text("Drive", exact=True)
    wait_for(lambda: title.bounding_box()["y"] + PLOT < drive.bounding_box()["y"], "the plot is seen")
    tab.close()


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
    with contextlib.suppress(PlaywrightError), tab.held("Right"):
        wait_for(lambda: web.turn() < -0.5, "the robot turns right")
        tab.close()
        wait_for(lambda: abs(web.turn()) < 0.05, "the robot stands")


@pytest.mark.slow
def test_two_pages_show_the_same_state_and_a_reloaded_one_too(web, tab, browser):
    other = Tab(browser, web.url)
    other.wait_for_text(READY)
    tab.click("Pause")
    wait_for(lambda: web.sim()["paused"], "the simulator is paused")
    for page in (tab, other):
        page.wait_for_text("s, paused")
    other.page.reload()
    other.wait_for_text("s, paused")
    other.click("Run")
    wait_for(lambda: not web.sim()["paused"], "the simulator runs")
    tab.wait_for_text("s, factor")
    other.close()


@pytest.mark.slow
def test_cancel_ends_the_goal_and_stops_the_robot(web, tab):
    results = Recorder(web.ros, "/aro_robocop_goto_as_node", "/robocop_goto_as/result")
    wait_for(results.connected, "a recorder of results")
    web.place(0.0, 0.0)
    web.set_factor(0.1)  # a browser that draws in software on a busy machine may take ten seconds for a click
    try:
        tab.click_floor(*SPAWN)  # it has to turn round first
        wait_for(tab.button("Cancel goal").is_enabled, "the goal is executed")
        tab.click("Cancel goal")
        result = wait_for(results.messages, "a result")[0]
    finally:
        web.set_factor(1.0)
    assert result["status"]["status"] == GoalStatus.PREEMPTED
    wait_for(web.stands, "the robot stands")
    tab.wait_for_text(r"goal\s+PREEMPTED \(.*\)[\s\S]*PREEMPTED: goal .*: it was cancelled")


@pytest.mark.slow
def test_reset_puts_robot_and_odometry_back_and_ends_what_is_shown_of_the_last_goal_and_the_server_goes_on(web, tab):
    tab.click_floor(*((0.0, 0.0) if web.position()[0] < -0.35 else SPAWN))
    tab.wait_for_text(r"goal\s+SUCCEEDED")
    web.place(0.0, 0.0)
    assert math.hypot(*web.position()) < 0.01
    tab.click("Reset")
    wait_for(lambda: math.dist(web.position(), SPAWN) < 0.01, lambda: f"the robot is at its start: {tab.text()}")
    wait_for(lambda: "SUCCEEDED" not in tab.text(), "the page no longer shows the goal")
    odometry = web.ros.latest("/odom")["pose"]["pose"]["position"]
    assert math.hypot(odometry["x"], odometry["y"]) < 0.01
    tab.click_floor(-0.5, 0.0)
    wait_for(lambda: math.dist(web.position(), (-0.5, 0.0)) < REACHED, "a goal is reached after the reset")


@pytest.mark.slow
def test_the_slider_sets_the_real_time_factor_and_the_page_shows_the_factor_reached(web, tab):
    slider = tab.slider("Factor")
    assert slider.get_attribute("aria-valuenow") == "1"
    try:
        for _ in range(5):
            slider.press("ArrowLeft")
        wait_for(lambda: web.sim()["factor_asked"] == 0.5, "the simulator is asked for half of real time")
        wait_for(lambda: abs(web.sim()["factor_reached"] - 0.5) < 0.05, "the simulator runs at half of real time")
        tab.wait_for_text(r"factor 0\.(4[5-9]|5[0-5])")
    finally:
        for _ in range(5):
            slider.press("ArrowRight")
    wait_for(lambda: web.sim()["factor_asked"] == 1.0, "the simulator is asked for real time")


BRIGHTNESS = """() => {  // of the scene's picture, from 0 to 255, and how much of it the browser shows
    const scene = document.querySelector('canvas[data-engine]'), copy = document.createElement('canvas');
    copy.width = copy.height = 64;
    const context = copy.getContext('2d');
    context.drawImage(scene, 0, 0, 64, 64);
    const pixels = context.getImageData(0, 0, 64, 64).data;
    return pixels.reduce((sum, value) => sum + value, 0) / pixels.length * getComputedStyle(scene).opacity;
}"""


@pytest.mark.slow
def test_the_scene_is_light(web, tab):
    wait_for(lambda: tab.page.evaluate(BRIGHTNESS) > 200, "a light scene")
