"""What the master knows -> published topics."""

from types import SimpleNamespace

import pytest
import rosgraph

from aro_robocop_goto_as.ros import graph

TYPES = [["/odom", "nav_msgs/Odometry"]]
PUBLISHERS = [["/odom", ["/sim"]], ["/old", []], ["/new", ["/a"]]]


@pytest.fixture(autouse=True)
def master(monkeypatch):
    known = SimpleNamespace(getTopicTypes=lambda: TYPES, getSystemState=lambda: (PUBLISHERS, [], []))
    monkeypatch.setattr(rosgraph, "Master", lambda _: known)


def test_topic_without_a_publisher_is_not_published_and_one_of_unknown_type_is():
    topics = {topic.name: topic for topic in graph.published_topics()}
    assert list(topics) == ["/new", "/odom"]
    assert topics["/new"] == graph.Topic("/new", "", ("/a",))
