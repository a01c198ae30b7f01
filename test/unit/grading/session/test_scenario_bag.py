"""A scenario's bag."""

import rosbag
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robocop_grading.session import scenario_bag as module


def test_a_topic_that_holds_is_one_that_rosbags_player_sends_also_when_it_begins_later(simulator, tmp_path):
    bag = module.ScenarioBag(simulator(), "world")
    bag.open(tmp_path / "a.bag")
    bag.write("/tf_static", TFMessage())
    bag.write("/other", String("x"))
    bag.close()
    with rosbag.Bag(tmp_path / "a.bag") as read:
        headers = {topic: header for topic, _, _, header in read.read_messages(return_connection_header=True)}
    assert headers["/tf_static"]["latching"] in ("1", b"1") and "latching" not in headers["/other"]


def test_a_bag_that_has_become_too_large_gets_no_more_messages(simulator, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "MAX_BAG", 10_000)
    bag = module.ScenarioBag(simulator(), "world")
    bag.open(tmp_path / "a.bag")
    for _ in range(10):
        bag.write("/other", String("x" * 3_000))
    bag.close()
    with rosbag.Bag(tmp_path / "a.bag") as read:
        assert 0 < read.get_message_count() < 5
