"""What a scenario's bag says of its topics."""

import rosbag
import rospy
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robocop_grading.session.topics import header


def test_a_topic_with_the_header_is_one_that_rosbags_player_sends_also_when_it_begins_later(tmp_path):
    with rosbag.Bag(tmp_path / "a.bag", "w") as bag:
        latched = header(TFMessage, topic="/tf_static", latching="1")
        bag.write("/tf_static", TFMessage(), rospy.Time(1), connection_header=latched)
        bag.write("/other", String("x"), rospy.Time(1))
    with rosbag.Bag(tmp_path / "a.bag") as bag:
        read = {topic: header for topic, _, _, header in bag.read_messages(return_connection_header=True)}
    assert read["/tf_static"]["latching"] in ("1", b"1") and "latching" not in read["/other"]
