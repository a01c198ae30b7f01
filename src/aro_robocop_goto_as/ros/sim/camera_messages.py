"""The messages of one robot's camera: colour, depth and points of one image."""

import io
from typing import Any, Callable, Dict, Tuple

import numpy as np
import ros_numpy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, PointCloud2
from std_msgs.msg import Header

from ...sensors.camera_image import CameraImage, CameraSpec, points_of

JPEG_QUALITY = 80  # of 100, as compressed_image_transport's default


def to_color(image: CameraImage, _spec: CameraSpec, header: Header) -> Image:
    """The colours."""
    message = ros_numpy.msgify(Image, np.ascontiguousarray(image.rgb), encoding="rgb8")
    message.header = header
    return message


def to_depth(image: CameraImage, _spec: CameraSpec, header: Header) -> Image:
    """The depths [m] as 32-bit floats."""
    message = ros_numpy.msgify(Image, image.depth, encoding="32FC1")
    message.header = header
    return message


def to_jpeg(image: CameraImage, _spec: CameraSpec, header: Header) -> CompressedImage:
    """The colours as a JPEG file, with the format text of compressed_image_transport."""
    from PIL import Image as Picture  # here, because its import takes long and most simulations have no camera

    file = io.BytesIO()
    Picture.fromarray(np.ascontiguousarray(image.rgb)).save(file, "JPEG", quality=JPEG_QUALITY)
    return CompressedImage(header, "rgb8; jpeg compressed bgr8", file.getvalue())


def to_camera_info(_image: CameraImage, spec: CameraSpec, header: Header) -> CameraInfo:
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


def to_points(image: CameraImage, spec: CameraSpec, header: Header) -> PointCloud2:
    """Points (height, width) with fields x, y, z [m] and rgb, packed into a float32 as PCL does."""
    points = points_of(image.depth, spec)
    cloud = np.empty(image.depth.shape, dtype=[(name, np.float32) for name in ("x", "y", "z", "rgb")])
    cloud["x"], cloud["y"], cloud["z"] = points[..., 0], points[..., 1], points[..., 2]
    rgb: np.ndarray = image.rgb.astype(np.uint32)
    cloud["rgb"] = (rgb[..., 0] << 16 | rgb[..., 1] << 8 | rgb[..., 2]).view(np.float32)
    return ros_numpy.msgify(PointCloud2, cloud, header.stamp, header.frame_id)


# By topics, which are named as the TurtleBot3's in Gazebo. Colour and depth share one lens: one frame, one calibration.
MESSAGES: Dict[str, Tuple[Any, Callable[[CameraImage, CameraSpec, Header], Any]]] = {
    "rgb/image_raw": (Image, to_color),
    "rgb/image_raw/compressed": (CompressedImage, to_jpeg),  # as image_transport names it
    "rgb/camera_info": (CameraInfo, to_camera_info),
    "depth/image_raw": (Image, to_depth),
    "depth/camera_info": (CameraInfo, to_camera_info),
    "depth/points": (PointCloud2, to_points),
}
