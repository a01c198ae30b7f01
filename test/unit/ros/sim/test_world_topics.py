"""A map as a message or as the response of /static_map is, byte for byte, what ROS makes of it."""

from io import BytesIO
from types import SimpleNamespace

import numpy as np
import pytest
from genpy import Time
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMapResponse

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.sim import world_topics
from aro_robocop_goto_as.ros.sim.world_topics import MapResponse, WorldTopics, to_grid
from aro_robocop_goto_as.world.model import Occupancy

CELLS = np.array([[-1, 0, 100], [50, -128, 127]], np.int8)


def _bytes_of(message):
    content = BytesIO()
    message.serialize(content)
    return content.getvalue()


@pytest.mark.filterwarnings("ignore:tostring")
def test_its_bytes_are_those_of_an_ordinary_message():
    packed = to_grid(Occupancy(CELLS, 0.05, Pose2D(-1.0, 2.0, 0.5)), Time(3, 4), "map")
    ordinary = OccupancyGrid(packed.header, packed.info, CELLS.ravel().tolist())
    assert (ordinary.info.width, ordinary.info.height, ordinary.header.stamp) == (3, 2, Time(3, 4))
    assert _bytes_of(packed) == _bytes_of(ordinary)
    assert _bytes_of(MapResponse(packed)) == _bytes_of(GetMapResponse(ordinary))


def test_the_whole_world_has_each_robots_name_in_its_frame(simulator, monkeypatch):
    sent = []
    monkeypatch.setattr(world_topics, "publisher", lambda *_, **__: SimpleNamespace(publish=sent.append))
    WorldTopics(simulator("empty")).publish()
    named = [(m.text, m.header.frame_id) for m in sent[-1]._make() if m.ns == "names"]
    assert named == [("robot_1", "robot_1/base_footprint")]
