"""`robocop grade --watch` without a display: a real Chromium shows the run, and the submission does not notice."""

import re

import pytest
import rosbag
from browser import Tab, chromium
from waiting import DEADLINE
from watched_grading import Watched
from web import NoDesktop

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("hosting"), pytest.mark.timeout(600)]

ADDRESS = r"open (http://localhost:\d+) in a browser"
SUCCEEDED = "            result.message = 'finished successfully'\n"
REPORTED = """
            counts = [topic.get_num_connections() for topic in (
                self.cmd_pub, *(getattr(self.server.action_server, name + '_pub') for name in ('feedback', 'result')))]
            result.message = 'subscribers %s' % counts
"""


class NoDisplay(NoDesktop):
    """The environment of a machine without a display."""

    environment = {name: value for name, value in NoDesktop.environment.items() if name != "DISPLAY"}


def with_subscribers_reported(source):
    """The server's source, with the number of its topics' subscribers in the result's message."""
    assert source.count(SUCCEEDED) == 1
    return source.replace(SUCCEEDED, REPORTED)


def test_the_page_shows_the_run_takes_no_requests_and_changes_nothing_for_the_submission(tmp_path):
    with Watched(tmp_path, NoDisplay(), change=with_subscribers_reported) as grading, chromium() as browser:
        address = grading.wait_for(lambda: re.search(ADDRESS, grading.process.output), "the page's address")
        tab = Tab(browser, address[1])
        # Its end, which stays: the run is at real time and may be over before a slow browser draws the panel.
        tab.wait_for_text(r"subscribers \[1, 1, 1\]")
        for label in ("Cancel goal", "Stop", "Reset"):
            assert not tab.button(label).is_visible(), label
        grading.wait_for_full_marks()
        foreign, errors = tab.foreign, tab.errors
    assert (foreign, [error for error in errors if "WebSocket" not in error]) == ([], [])


def test_report_on_a_misspelt_server_names_nothing_that_only_shows_the_run(tmp_path):
    def misspelt(source):
        return source.replace("'robocop_goto_as', GoTo", "'robovop_goto_as', GoTo")

    with Watched(tmp_path, NoDisplay(), change=misspelt) as grading, chromium() as browser:
        address = grading.wait_for(lambda: re.search(ADDRESS, grading.process.output), "the page's address")
        tab = Tab(browser, address[1])
        assert grading.process.wait(DEADLINE) == 1, grading.process.output
        tab.text()  # has playwright deliver its events
        assert tab.sockets, "the page was not open"
    assert "robovop_goto_as; the handout says robocop_goto_as" in grading.process.output
    assert "robocop_watch" not in grading.process.output


def test_without_a_browser_the_run_begins_after_a_minute_and_gets_the_same_points(tmp_path):
    with Watched(tmp_path, NoDisplay(), change=with_subscribers_reported) as grading:
        grading.wait_for_full_marks()
    with rosbag.Bag(tmp_path / "report" / "server-beside_a_wall.bag") as bag:
        results = [message.result.message for _, message, _ in bag.read_messages("/robocop_goto_as/result")]
    assert results == ["subscribers [1, 1, 1]"]
