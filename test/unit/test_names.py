"""Names of topics and frames, from the names of robots."""

import pytest

from aro_robocop_goto_as import names


def test_name_of_a_robot_is_a_prefix_of_its_relative_topics_and_frames():
    assert names.prefixed("red", "odom") == "red/odom"
    assert names.prefixed("", "odom") == "odom"


@pytest.mark.parametrize("robot, topic", [("", "/cmd_vel"), ("red", "/red/cmd_vel"), ("/red/", "/red/cmd_vel")])
def test_absolute_topic_begins_with_one_slash(robot, topic):
    assert names.absolute(robot, "cmd_vel") == topic


def test_topic_of_no_robot_stays_in_the_namespace_of_the_node_and_that_of_a_named_one_does_not():
    assert names.absolute_if_named("", "odom") == "odom"
    assert names.absolute_if_named("red", "odom") == "/red/odom"
