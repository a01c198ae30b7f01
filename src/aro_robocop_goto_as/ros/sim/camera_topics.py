"""The topics of one robot's camera: colour, depth and points; only messages with a subscriber are made."""

import io
from typing import Callable, Dict

import numpy as np
import ros_numpy
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, PointCloud2
from std_msgs.msg import Header

from ...sensors.camera import CameraImage, CameraSpec, points_of
from ..publishing import publisher

COLOR, COLOR_INFO = "camera/rgb/image_raw", "camera/rgb/camera_info"
COMPRESSED = f"{COLOR}/compressed"  # as image_transport names it
DEPTH, DEPTH_INFO, POINTS = "camera/depth/image_raw", "camera/depth/camera_info", "camera/depth/points"
KINDS = {
    COLOR: Image,
    COMPRESSED: CompressedImage,
    COLOR_INFO: CameraInfo,
    DEPTH: Image,
    DEPTH_INFO: CameraInfo,
    POINTS: PointCloud2,
}
JPEG_QUALITY = 80  # of 100, as compressed_image_transport's default


class CameraTopics:
    """Topics named as the TurtleBot3's in Gazebo. Colour and depth share one lens: one frame, one calibration."""

    def __init__(self, prefix: str, spec: CameraSpec, frame: str, on_change: Callable[[], None]) -> None:
        self._spec = spec
        self._frame = frame
        self._topics: Dict[str, rospy.Publisher] = {
            name: publisher(prefix + name, kind, on_change=on_change) for name, kind in KINDS.items()
        }

    def get_num_connections(self) -> int:
        """The number of subscribers of all topics."""
        return sum(topic.get_num_connections() for topic in self._topics.values())

    def publish(self, image: CameraImage, stamp: rospy.Time) -> None:
        """Publish all messages with a subscriber, from one image."""
        header = Header(0, stamp, self._frame)
        for name, topic in self._topics.items():
            if topic.get_num_connections():
                topic.publish(self._message(name, image, header))

    def _message(self, name: str, image: CameraImage, header: Header) -> rospy.Message:
        if name == POINTS:
            return ros_numpy.msgify(PointCloud2, to_cloud(image, self._spec), header.stamp, header.frame_id)
        if name == COMPRESSED:
            return to_jpeg(image, header)
        if name in (COLOR_INFO, DEPTH_INFO):
            return to_camera_info(self._spec, header)
        message = (
            ros_numpy.msgify(Image, np.ascontiguousarray(image.rgb), encoding="rgb8")
            if name == COLOR
            else ros_numpy.msgify(Image, image.depth, encoding="32FC1")
        )
        message.header = header
        return message


def to_jpeg(image: CameraImage, header: Header) -> CompressedImage:
    """The colours as a JPEG file, with the format text of compressed_image_transport."""
    from PIL import Image as Picture  # here, because its import takes long and most simulations have no camera

    file = io.BytesIO()
    Picture.fromarray(np.ascontiguousarray(image.rgb)).save(file, "JPEG", quality=JPEG_QUALITY)
    return CompressedImage(header, "rgb8; jpeg compressed bgr8", file.getvalue())


def to_camera_info(spec: CameraSpec, header: Header) -> CameraInfo:
    """The calibration of a pinhole camera without distortion."""
    f, x, y = spec.focal, spec.centre_x, spec.centre_y
    return CameraInfo(
        header=header,
        width=spec.width,
        height=spec.height,
        distortion_model="plumb_bob",
        D=[0.0] * 5,
        K=[f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[f, 0.0, x, 0.0, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def to_cloud(image: CameraImage, spec: CameraSpec) -> np.ndarray:
    """Points (height, width) with fields x, y, z [m] and rgb, packed into a float32 as PCL does."""
    points = points_of(image.depth, spec)
    cloud = np.empty(image.depth.shape, dtype=[(name, np.float32) for name in ("x", "y", "z", "rgb")])
    cloud["x"], cloud["y"], cloud["z"] = points[..., 0], points[..., 1], points[..., 2]
    rgb: np.ndarray = image.rgb.astype(np.uint32)
    cloud["rgb"] = (rgb[..., 0] << 16 | rgb[..., 1] << 8 | rgb[..., 2]).view(np.float32)
    return cloud
