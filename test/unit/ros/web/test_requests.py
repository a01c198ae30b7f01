"""Visitors' requests: what one of them fails with is its answer, and the next one is served."""

import pytest
from waiting import wait_for

from aro_robocop_goto_as.ros.web import requests
from aro_robocop_goto_as.web.state import PageState, SharedState


class Service:
    """Stands in for all services: a call raises what is in `problems`, then it answers."""

    message = "running"

    def __init__(self, monkeypatch, problems):
        self.problems = problems
        monkeypatch.setattr(requests.rospy, "wait_for_service", lambda *_: None)
        monkeypatch.setattr(requests.rospy, "ServiceProxy", lambda *_: self)

    def __call__(self, *_):
        if self.problems:
            raise self.problems.pop()
        return self


@pytest.mark.parametrize("kind", [requests.rospy.ServiceException, requests.rospy.ROSException])  # refused; not there
def test_a_request_that_fails_says_so_and_the_next_one_is_served(monkeypatch, kind):
    Service(monkeypatch, [kind("no such robot")])
    state = SharedState(PageState())
    made = requests.Requests(state)
    made.call("pause", "pause", object)
    wait_for(lambda: state.now.answer == "pause: no such robot", "the failure is the answer")
    made.call("continue", "unpause", object)
    wait_for(lambda: not state.now.answer, "the next request is served")


def test_a_page_that_only_watches_sends_nothing(monkeypatch):
    Service(monkeypatch, [requests.rospy.ServiceException("it was called")])
    state = SharedState(PageState(can_send=False))
    made = requests.Requests(state)
    made.call("pause", "pause", object)
    made._worker.shutdown()
    assert not state.now.answer
