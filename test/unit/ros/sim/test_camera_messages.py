"""A camera's messages: image, calibration and points describe the same pixels; only a robot with a camera has them."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
import ros_numpy
from genpy import Time
from PIL import Image as Picture
from std_msgs.msg import Header
from support import driven

from aro_robocop_goto_as.geometry import STANDSTILL
from aro_robocop_goto_as.ros.sim import camera_messages, step_topics
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics
from aro_robocop_goto_as.sensors.camera_image import CameraImage, CameraSpec

SPEC = CameraSpec(32, 16, 1.2, 0.1, 8.0)
HEADER = Header(0, Time(3, 4), "camera_rgb_optical_frame")
DEPTH = np.linspace(0.5, 4.0, 32 * 16, dtype=np.float32).reshape(16, 32)
DEPTH[2, 3] = np.inf
RGB = np.zeros((16, 32, 3), np.uint8) + np.array((200, 100, 30), np.uint8)
RGB[8:] = (20, 40, 180)
IMAGE = CameraImage(RGB, DEPTH)
SENT = [  # topic, encoding or kind
    ["rgb/image_raw", "rgb8"],
    ["rgb/camera_info", "CameraInfo"],
    ["depth/image_raw", "32FC1"],
    ["depth/camera_info", "CameraInfo"],
    ["depth/points", "PointCloud2"],
]
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:ros_numpy")


def test_colours_are_in_the_order_of_the_encoding_also_in_the_compressed_image():
    image = camera_messages.to_color(IMAGE, SPEC, HEADER)
    assert (image.encoding, image.width, image.height, image.step) == ("rgb8", 32, 16, 96)
    np.testing.assert_array_equal(ros_numpy.numpify(image), RGB)
    jpeg = camera_messages.to_jpeg(IMAGE, SPEC, HEADER)
    assert jpeg.format == "rgb8; jpeg compressed bgr8"
    picture = np.asarray(Picture.open(io.BytesIO(jpeg.data)).convert("RGB")).astype(int)
    assert np.abs(picture - RGB).mean() < 20.0  # 113 with red and blue exchanged


def test_points_match_depth_colour_and_calibration():
    image, info = (make(IMAGE, SPEC, HEADER) for make in (camera_messages.to_depth, camera_messages.to_camera_info))
    points = ros_numpy.numpify(camera_messages.to_points(IMAGE, SPEC, HEADER))
    depth = ros_numpy.numpify(image)
    assert (image.encoding, info.width, info.height) == ("32FC1", 32, 16)
    np.testing.assert_array_equal(depth, DEPTH)
    rows, columns = np.nonzero(np.isfinite(depth))
    scene = np.stack([points[axis][rows, columns] for axis in ("x", "y", "z")])
    assert len(rows) == depth.size - 1 and np.isnan(points["z"][2, 3])
    seen = np.array(info.P).reshape(3, 4)[:, :3] @ scene
    assert info.K == [value for row in (info.P[:3], info.P[4:7], info.P[8:11]) for value in row]
    np.testing.assert_allclose(seen, np.stack([columns, rows, np.ones(len(rows))]) * depth[rows, columns], atol=1e-4)
    packed = points["rgb"].view(np.uint32)
    np.testing.assert_array_equal(np.stack([packed >> 16 & 255, packed >> 8 & 255, packed & 255], axis=-1), RGB)


@pytest.mark.parametrize("model, count", [("burger", 0), ("burger_rgbd", 5)])
def test_what_has_a_subscriber_is_sent_with_the_frame_and_the_stamp_of_one_image(simulator, monkeypatch, model, count):
    sent = []

    def publisher(topic, kind, **__):
        def publish(message):
            sent.append((topic.partition("camera/")[2], getattr(message, "encoding", kind.__name__), message.header))

        subscribers = int("camera" in topic and "compressed" not in topic)
        return SimpleNamespace(get_num_connections=lambda: subscribers, publish=publish, impl=None, links=())

    monkeypatch.setattr(step_topics, "publisher", publisher)
    monkeypatch.setattr(step_topics, "set_latched", lambda *_: None)
    sim = simulator("empty", model=model)
    topics = StepTopics(sim)
    (*_, due) = (due for due in driven(sim, STANDSTILL, 0.1, ["camera"]) if due.of("camera"))
    topics.publish(due)
    stamps = [(header.frame_id, header.stamp.to_nsec()) for *_, header in sent]
    assert stamps == [("robot_1/camera_rgb_optical_frame", sim.stamp_ns)] * count
    assert [what for *what, _ in sent] == SENT[:count]
