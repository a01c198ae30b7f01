"""What the master knows -> topics and action servers."""

from types import SimpleNamespace

import pytest
import rosgraph

from aro_robocop_goto_as.ros import graph

TYPES = [["/odom", "nav_msgs/Odometry"], ["/go/result", "p/GoActionResult"], ["/x/result", "std_msgs/String"]]
PUBLISHERS = [["/odom", ["/sim"]], ["/go/result", ["/server"]], ["/x/result", ["/me"]], ["/old", []], ["/new", ["/a"]]]


@pytest.fixture(autouse=True)
def master(monkeypatch):
    known = SimpleNamespace(getTopicTypes=lambda: TYPES, getSystemState=lambda: (PUBLISHERS, [], []))
    monkeypatch.setattr(rosgraph, "Master", lambda _: known)


def test_topic_without_a_publisher_is_not_published_and_one_of_unknown_type_is():
    topics = {topic.name: topic for topic in graph.published_topics()}
    assert list(topics) == ["/go/result", "/new", "/odom", "/x/result"]
    assert topics["/new"] == graph.Topic("/new", "", ("/a",))


def test_action_server_is_known_by_the_type_of_its_result():
    assert graph.action_servers() == {"/go": "p/GoAction"}
