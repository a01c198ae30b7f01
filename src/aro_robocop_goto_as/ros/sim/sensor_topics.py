"""The topics on which one robot's measurements are published, packed ones stamped by batch.c, others by rospy."""

from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from ...names import prefixed
from ...robot.model import CAMERA_FRAME
from ...sensors.camera import CAMERA
from ...sensors.scanner import SCAN
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing.packed import PackedMessage, counter
from ..publishing.publisher import publisher
from .sensor_messages import TOPICS, Robot


class SensorTopics:
    """Publishers in a robot's namespace; its frames carry its name as a prefix."""

    def __init__(self, index: int, simulator: Simulator, on_change: Callable[[], None]) -> None:
        """`on_change` is called when a subscriber of any topic connects or disconnects."""
        p, observed, name = simulator.params, simulator.observed, simulator.robots[index].name
        self._robot = Robot(index, name, p, observed, counter())
        self.odom_frame, self.footprint_frame = (
            self._robot.frame(it) for it in (p.frames.odom_frame, p.frames.base_frame)
        )
        self._packed: Dict[Tuple[str, int], PackedMessage] = {}  # by sensor and, for a scan, its number of beams
        self.topics: Dict[str, Any] = {  # by sensor
            sensor: publisher(prefixed(name, topic.name), topic.kind, on_change=on_change)
            for sensor, topic in TOPICS.items()
            if observed.by_name[sensor].rate
        }
        camera = observed.camera.specs[index]
        if camera is not None and observed.camera.rate:
            from .camera_topics import CameraTopics

            frame = prefixed(name, CAMERA_FRAME)
            self.topics[CAMERA] = CameraTopics(prefixed(name, ""), camera, frame, on_change)

    def packed(self, sensor: str) -> Optional[PackedMessage]:
        """The message of the newest measurement; None if publish() sends it."""
        pack = TOPICS[sensor].packed if sensor in TOPICS else None
        if pack is None:
            return None
        key = sensor, self._robot.observed.scan.ranges.shape[1] if sensor == SCAN else 0
        if key not in self._packed:
            self._packed[key] = pack(self._robot)
        return self._packed[key]

    def publish(self, sensor: str) -> None:
        """Publish the newest measurement of a sensor whose message is not packed."""
        robot, topic = self._robot, self.topics[sensor]
        message = TOPICS[sensor].message if sensor in TOPICS else None
        if message is not None:
            topic.publish(message(robot))
        elif robot.row in robot.observed.camera.images:
            topic.publish(robot.observed.camera.images[robot.row], convert.to_time(robot.observed.stamp_ns))

    def transforms(self) -> List[Tuple[str, str, np.ndarray]]:
        """Parent, child and parent_from_child (3,): odom -> base; map -> odom if it follows ground truth."""
        p, odometry, row = self._robot.params, self._robot.observed.odometry, self._robot.row
        found = []
        if p.topics.odom_tf:
            found.append((self.odom_frame, self.footprint_frame, odometry.poses[row]))
        if p.topics.localization == "truth":
            found.append((p.frames.map_frame, self.odom_frame, odometry.map_from_odom[row]))
        return found
