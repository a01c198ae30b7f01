"""Scans, maps and camera images as arrays for the page."""

from typing import Any, Optional

import numpy as np
from sensor_msgs.msg import Image, LaserScan

LARGEST_MAP = 2000  # cells along a side; larger maps are thinned out
UNKNOWN, FREE, OCCUPIED = (90, 95, 105, 120), (205, 210, 216, 60), (20, 22, 26, 255)  # red, green, blue, opacity


def scan_points(scan: LaserScan) -> np.ndarray:
    """Points (n, 3) [m] of the valid returns, in the scanner's frame."""
    ranges = np.array(scan.ranges, dtype=float)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    with np.errstate(invalid="ignore"):
        valid = np.isfinite(ranges) & (ranges >= scan.range_min) & (ranges <= scan.range_max) & (ranges > 0.0)
    ranges, angles = ranges[valid], angles[valid]
    return np.stack([ranges * np.cos(angles), ranges * np.sin(angles), np.zeros(len(ranges))], axis=1)


def map_image(data: Any, columns: int, rows: int) -> np.ndarray:
    """Cells of an occupancy grid, row by row from its origin -> an image (rows, columns, 4).

    The first row has the lowest y in both: viser's images have x to the right and y down, as cameras do.
    """
    cells = np.array(data, dtype=np.int16).reshape(rows, columns)
    stride = -(-max(rows, columns) // LARGEST_MAP)
    cells = cells[::stride, ::stride]
    share = np.clip(cells, 0, 100)[..., np.newaxis] / 100.0
    image = np.array(FREE) * (1.0 - share) + np.array(OCCUPIED) * share
    image[cells < 0] = UNKNOWN
    return image.astype(np.uint8)


def camera_image(message: Image) -> Optional[np.ndarray]:
    """A colour or grey image (rows, columns, 3); None for other encodings."""
    channels = {"rgb8": 3, "bgr8": 3, "mono8": 1}.get(message.encoding)
    if channels is None or message.step < message.width * channels or len(message.data) < message.height * message.step:
        return None
    rows = np.frombuffer(message.data, np.uint8, message.height * message.step).reshape(message.height, message.step)
    pixels = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
    if channels == 1:
        return np.repeat(pixels, 3, axis=2)
    return np.ascontiguousarray(pixels[..., ::-1] if message.encoding == "bgr8" else pixels)
