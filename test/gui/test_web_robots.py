"""The web page with two robots: the one that is chosen is driven, gets the goals and is described; the other rests."""

import math

import pytest
from browser import Tab
from waiting import wait_for
from web import REACHED, Web

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("web page"), pytest.mark.timeout(600)]

FIRST, SECOND = "robot_1", "robot_2"
READY = r"empty[\s\S]*server\s+ready"
AWAY = 0.5  # [m]


@pytest.fixture(scope="module")
def web(tmp_path_factory):
    web = Web(tmp_path_factory.mktemp("web_robots"), "world:=empty", "robots:=2")
    with web.ros:
        web.start()
        yield web


@pytest.fixture
def tab(web, browser):
    tab = Tab(browser, web.url)
    tab.wait_for_text(READY)
    tab.choose(FIRST, SECOND)
    yield tab
    tab.close()


def test_the_robot_that_is_chosen_is_driven_and_no_other(web, tab):
    with tab.held("Right"):
        wait_for(lambda: web.turn(SECOND) < -0.5, f"{SECOND} turns right")
        assert web.stands(FIRST)
    wait_for(lambda: web.stands(SECOND), f"{SECOND} stands")
    tab.choose(SECOND, FIRST)
    with tab.held("Left"):
        wait_for(lambda: web.turn(FIRST) > 0.5, f"{FIRST} turns left")
        assert web.stands(SECOND)
    wait_for(lambda: web.stands(FIRST), f"{FIRST} stands")


def test_a_click_sends_the_goal_to_the_robot_that_is_chosen_and_its_end_is_shown(web, tab):
    (first_x, first_y), (x, y) = web.position(FIRST), web.position(SECOND)
    share = AWAY / math.hypot(x - first_x, y - first_y)
    goal = x + share * (x - first_x), y + share * (y - first_y)  # straight away from the other robot
    tab.click_floor(*goal)
    tab.wait_for_text("SUCCEEDED")
    assert math.dist(web.position(SECOND), goal) < REACHED
    assert math.dist(web.position(FIRST), (first_x, first_y)) < 0.01
