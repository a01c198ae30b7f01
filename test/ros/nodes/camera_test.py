"""Images, calibration and points of a camera are of one step and match each other."""

import io
import unittest

import numpy as np
import ros_numpy
import rospy
from harness import Recorder
from PIL import Image as Picture
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, PointCloud2

FRAME = "red/camera_rgb_optical_frame"


class Camera(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        topics = {
            "rgb/image_raw": Image,
            "rgb/image_raw/compressed": CompressedImage,
            "rgb/camera_info": CameraInfo,
            "depth/image_raw": Image,
            "depth/camera_info": CameraInfo,
            "depth/points": PointCloud2,
        }
        recorders = {name: Recorder(f"red/camera/{name}", kind) for name, kind in topics.items()}
        start = max(recorder.newest().header.stamp for recorder in recorders.values())
        cls.of_one_step = {
            name: recorder.wait_for(lambda m: m.header.stamp > start, "a message from after all topics had one")
            for name, recorder in recorders.items()
        }

    def test_all_messages_are_of_one_step_and_in_the_optical_frame(self):
        headers = [message.header for message in self.of_one_step.values()]
        self.assertEqual({header.frame_id for header in headers}, {FRAME})
        self.assertEqual(len({header.stamp for header in headers}), 1)

    def test_colours_are_in_the_order_of_the_encoding_also_in_the_compressed_image(self):
        image = self.of_one_step["rgb/image_raw"]
        self.assertEqual((image.encoding, image.width, image.height, image.step), ("rgb8", 160, 120, 480))
        rgb = ros_numpy.numpify(image).astype(int)
        red, blue = rgb[..., 0], rgb[..., 2]
        self.assertGreater((blue - red)[:40].mean(), 20)  # sky or wall, which are bluish
        self.assertLess((blue - red)[-10:].mean(), 5)  # floor
        picture = Picture.open(io.BytesIO(self.of_one_step["rgb/image_raw/compressed"].data)).convert("RGB")
        self.assertLess(np.abs(np.asarray(picture).astype(int) - rgb).mean(), 5.0)

    def test_points_match_depth_colour_and_calibration(self):
        depth = ros_numpy.numpify(self.of_one_step["depth/image_raw"])
        self.assertEqual(self.of_one_step["depth/image_raw"].encoding, "32FC1")
        self.assertEqual(depth.shape, (120, 160))
        info, cloud = self.of_one_step["rgb/camera_info"], self.of_one_step["depth/points"]
        self.assertEqual(
            (info.K, info.P), (self.of_one_step["depth/camera_info"].K, self.of_one_step["depth/camera_info"].P)
        )
        points = ros_numpy.numpify(cloud)
        self.assertEqual(points.shape, depth.shape)
        rows, columns = np.nonzero(np.isfinite(depth))
        for axis, pixels, scale, centre in (("x", columns, info.K[0], info.K[2]), ("y", rows, info.K[4], info.K[5])):
            np.testing.assert_allclose(
                points[axis][rows, columns], depth[rows, columns] * (pixels - centre) / scale, atol=1e-5
            )
        np.testing.assert_array_equal(points["z"][rows, columns], depth[rows, columns])
        packed = points["rgb"].view(np.uint32)
        rgb = ros_numpy.numpify(self.of_one_step["rgb/image_raw"])
        np.testing.assert_array_equal(np.stack([packed >> 16 & 255, packed >> 8 & 255, packed & 255], axis=-1), rgb)

    def test_robot_without_a_camera_has_no_camera_topics(self):
        names = [name for name, _ in rospy.get_published_topics()]
        self.assertFalse([name for name in names if name.startswith("/green/camera")])
