"""What replaces private parts of rospy."""

import time
from typing import Any, List

import pytest
import rospy

from aro_robocop_goto_as.ros.rospy_internals import start_quickly


@pytest.fixture(autouse=True)
def _restored(monkeypatch: pytest.MonkeyPatch) -> None:
    """rospy as it was, after the test."""
    monkeypatch.setattr(rospy.impl.init, "time", time)
    statistics = rospy.impl.statistics.SubscriberStatisticsLogger
    monkeypatch.setattr(statistics, "is_enabled", statistics.is_enabled)


def test_init_node_looks_for_its_registration_each_millisecond(monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: List[float] = []
    looks = iter([False, False, True])
    monkeypatch.setattr(time, "sleep", pauses.append)
    monkeypatch.setattr(rospy.impl.init, "init_tcpros", lambda port: None)
    monkeypatch.setattr(rospy.impl.init, "_set_caller_id", lambda name: None)

    class Registering:
        uri = "http://localhost:1"

        def __init__(self, *_: Any, **__: Any) -> None:
            pass

        def start(self) -> None:
            pass

        def _is_registered(self) -> bool:
            return next(looks)

    monkeypatch.setattr(rospy.impl.init, "ROSHandler", Registering)
    monkeypatch.setattr(rospy.impl.init.rosgraph.xmlrpc, "XmlRpcNode", Registering)
    start_quickly()
    rospy.impl.init.start_node({}, "/node")
    assert pauses == [1e-3, 1e-3]


def test_the_master_is_asked_once_for_statistics_of_subscribers(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: List[str] = []
    monkeypatch.setattr(rospy, "get_param", lambda name, default: asked.append(name) or default)
    start_quickly()
    assert [rospy.impl.statistics.SubscriberStatisticsLogger.is_enabled() for _ in range(3)] == [False] * 3
    assert asked == ["/enable_statistics"]
