"""The grader's end of the topics that it shares with a node."""

import io
import json

import pytest
from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import GoToPositionActionGoal, GoToPositionActionResult
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64, String

from robocop_grading.agent import wire
from robocop_grading.errors import GraderLostError
from robocop_grading.record import MAX_TEXT
from robocop_grading.session.topics import MAX_WAITING, Topics


def serialized(message):
    body = io.BytesIO()
    message.serialize(body)
    return wire.LENGTH.pack(body.tell()) + body.getvalue()


@pytest.fixture
def topics():
    """With a topic that is sent, a latched one, and two that are heard; `heard` has what has arrived."""
    made = Topics()
    made.heard = []
    made.advertise("/sent", PoseStamped)
    made.advertise("/latched", Float64, latch=True)
    for name in ("/b", "/a"):
        made.subscribe(name, String, lambda message, name=name: made.heard.append((name, message.data)))
    return made


def told(topics, published=(), subscribed=()):
    named = [[[name, kind._md5sum, kind._type] for name, kind in those] for those in (published, subscribed)]
    topics.update_node_topics(
        json.dumps({"published": named[0], "subscribed": named[1], "programs": [], "delays": []}).encode()
    )


def test_what_has_arrived_is_handled_in_the_order_of_topics_and_of_each_topics_messages(topics):
    stream = serialized(String("1")) + serialized(String("2"))
    for part in (stream[:3], stream[3:9], stream[9:]):
        topics.receive("/b", part)
    topics.receive("/a", serialized(String("3")))
    topics.handle_arrived()
    assert topics.heard == [("/a", "3"), ("/b", "1"), ("/b", "2")]


def test_rubbish_after_which_a_stream_begins_anew_costs_what_comes_with_it(topics):
    partly = wire.LENGTH.pack(0) + b"half a message"  # what rospy has of one that could not be serialized
    topics.receive("/a", partly + serialized(String("lost")))
    topics.receive("/a", serialized(String("next")))
    topics.handle_arrived()
    assert topics.heard == [("/a", "next")]


def test_of_a_flood_and_of_a_long_text_a_part_is_kept(topics):
    for _ in range(MAX_WAITING + 10):
        topics.receive("/a", serialized(String("x")))
    topics.receive("/unknown", b"anything")
    topics.handle_arrived()
    assert len(topics.heard) == MAX_WAITING
    topics.receive("/a", serialized(String("x" * 10 * MAX_TEXT)))
    topics.handle_arrived()
    assert len(topics.heard[-1][1]) == MAX_TEXT


def test_only_what_the_node_hears_is_sent_and_what_is_latched(topics):
    topics.publish("/sent", PoseStamped())
    topics.publish("/latched", Float64(1.0))
    assert topics.take()[1] == [("/latched", serialized(Float64(1.0)))]
    told(topics, subscribed=[("/sent", PoseStamped)])
    for number in (2, 3):
        topics.publish("/sent", PoseStamped())
        (_, data), *_ = topics.take()[1]
        assert PoseStamped().deserialize(data[4:]).header.seq == number
    topics.begin()
    assert topics.take()[1] == [("/latched", serialized(Float64(1.0)))] and not topics.node_subscribes_to("/sent")


def test_topics_of_other_types_are_not_connected_but_named(topics):
    told(topics, [("/a", String), ("/b", Float64), ("/mine", String)], [("/sent", GoalID), ("/nothing", String)])
    assert topics.node_publishes("/a") and not topics.node_publishes("/b") and not topics.node_subscribes_to("/sent")
    assert topics.other_types() == (
        ("/b", "std_msgs/Float64", "std_msgs/String"),
        ("/sent", "actionlib_msgs/GoalID", "geometry_msgs/PoseStamped"),
    )
    assert topics.unpublished() == ["/nothing"]


def test_only_action_of_the_handouts_type_has_the_handouts_name_for_the_grader(topics):
    topics.advertise("/robocop_goto_as/goal", GoToPositionActionGoal)
    topics.subscribe("/robocop_goto_as/result", GoToPositionActionResult, topics.heard.append)
    topics.take()
    told(topics, [("/x/y/result", GoToPositionActionResult)], [("/x/y/goal", GoToPositionActionGoal)])
    assert topics.node_publishes("/robocop_goto_as/result")
    topics.publish("/robocop_goto_as/goal", GoToPositionActionGoal())
    offered, ((name, _),) = topics.take()
    assert {it["topic"] for it in offered} == {"/x/y/goal", "/x/y/result"} and name == "/x/y/goal"
    topics.receive("/x/y/result", serialized(GoToPositionActionResult()))
    topics.handle_arrived()
    assert topics.heard == [GoToPositionActionResult()]
    told(topics, [], [("/x/y/goal", GoToPositionActionGoal), ("/z/goal", GoToPositionActionGoal)])
    assert not topics.node_subscribes_to("/robocop_goto_as/goal")


@pytest.mark.parametrize("body", [b"", b"[]", b"[" * 100_000, b'{"published": 7, "subscribed": [[1]]}', b"\xff"])
def test_topics_that_can_not_be_read_end_the_run(body, topics):
    with pytest.raises(GraderLostError, match="topics can't be read"):
        topics.update_node_topics(body)
