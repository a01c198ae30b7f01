"""Display options: the trail and the camera's image."""

import time
from dataclasses import replace
from typing import Optional

import numpy as np
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image

from ...names import absolute
from ...web.scene import LINE, Group, Visual
from ...web.state import PageState
from ..trail import Trail
from .part import Context, Inbox, Part

CAMERA = "camera/rgb/image_raw"
IMAGE_PERIOD = 0.25  # [s, wall] between two images
TRAIL_LINE = Visual(LINE, (0.012, 0.0, 0.0), (90, 200, 250))


class ViewPart(Part):
    """The options of the 3D scene, and the camera's image."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, state = context.server.gui, context.state.now
        self._with_trail = gui.add_checkbox("Trail", state.can_send or state.recorded)
        self._image = gui.add_image(np.zeros((3, 4, 3), np.uint8), label="camera", visible=False)
        self._message: Optional[Image] = None  # that is not shown yet
        self._image_at = 0.0  # [s, wall]
        self._trail, self._odom = Trail(), ""  # and its frame

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        self._trail = Trail()
        self._message = None
        self._image.visible = False
        inbox.subscribe(absolute(robot, "odom"), Odometry, self._on_odometry, None)  # all, or a jump is no jump
        inbox.subscribe(absolute(robot, CAMERA), Image, self._on_image)

    def _on_odometry(self, _: float, message: Odometry) -> None:
        position = message.pose.pose.position
        self._odom = message.header.frame_id
        if self._trail.add(message.header.stamp.to_sec(), position.x, position.y):
            self.context.state.change(resets=self.context.state.now.resets + 1)

    def _on_image(self, _: float, message: Image) -> None:
        self._message = message

    def show(self, state: PageState) -> None:
        self._show_trail()
        self._show_image()

    def _show_trail(self) -> None:
        group: Group = {}
        points, pose = self._trail.points, self.context.locate(self._odom)
        if self._with_trail.value and len(points) > 1 and pose is not None:
            group["trail"] = (replace(TRAIL_LINE, points=points), pose)
        self.context.scene.show("trail", group)

    def _show_image(self) -> None:
        now = time.monotonic()
        if self._message is not None and now - self._image_at >= IMAGE_PERIOD:
            image = camera_image(self._message)
            self._message, self._image_at = None, now
            if image is not None:
                self._image.image = image
            self._image.visible = image is not None


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
