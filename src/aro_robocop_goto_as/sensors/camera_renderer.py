"""Render camera images with Bullet's software renderer, in a Bullet world of its own without physics.

So both engines have cameras, and rendering never affects the simulation.
"""

from typing import List, Sequence, Tuple

import numpy as np

from ..geometry import Pose3D, compose3, rotation_matrix
from ..physics.bullet_shapes import FLOOR, load_urdf, visual_shapes
from ..physics.quiet_pybullet import pybullet
from ..robot.model import RobotModel
from ..world.ground import is_in_ground
from ..world.model import Obstacle, World
from .camera_image import CameraImage, CameraSpec, depth_of, projection

OUT_OF_SIGHT = (0.0, 0.0, -1e4)  # [m] where a robot is placed while its own camera renders
SKY = np.array([178, 200, 222], np.uint8)


class CameraRenderer:
    """Renders one world and its robots, at their poses but with their wheels at angle zero."""

    def __init__(self, world: World, models: Sequence[RobotModel]) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._moving: List[Tuple[int, Obstacle]] = []
        others = [obstacle for obstacle in world.obstacles if not is_in_ground(obstacle)]
        for obstacle in (FLOOR, *others):
            for visual in visual_shapes(obstacle.geometry, self._client):
                body = pybullet.createMultiBody(
                    0.0, -1, visual, obstacle.pose.position, obstacle.pose.orientation, physicsClientId=self._client
                )
                if obstacle.motion is not None:
                    self._moving.append((body, obstacle))
        self._robots = [load_urdf(model, self._client) for model in models]

    def render(
        self, spec: CameraSpec, world_from_optical: Pose3D, robot: int, world_from_bases: Sequence[Pose3D], time: float
    ) -> CameraImage:
        """What a robot's camera sees at a time [s]: the world and all other robots."""
        for body, obstacle in self._moving:
            self._place(body, obstacle.at(time))
        for index, ((body, base_from_inertial), pose) in enumerate(zip(self._robots, world_from_bases)):
            self._place(body, Pose3D(OUT_OF_SIGHT) if index == robot else compose3(pose, base_from_inertial))
        _, _, pixels, buffer, _ = pybullet.getCameraImage(
            spec.width,
            spec.height,
            _view(world_from_optical),
            projection(spec),
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            flags=pybullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        # Arrays, or tuples where pybullet was built without NumPy; through bytes, a tuple is ten times as fast.
        depth = depth_of(np.reshape(buffer, (spec.height, spec.width)), spec)
        rgb = np.frombuffer(bytes(pixels), np.uint8).reshape(spec.height, spec.width, 4)[..., :3]
        return CameraImage(np.where(np.isfinite(depth)[..., None], rgb, SKY), depth)

    def _place(self, body: int, pose: Pose3D) -> None:
        pybullet.resetBasePositionAndOrientation(body, pose.position, pose.orientation, physicsClientId=self._client)

    def close(self) -> None:
        """Disconnect from Bullet, which frees its memory."""
        pybullet.disconnect(physicsClientId=self._client)


def _view(world_from_optical: Pose3D) -> List[float]:
    """OpenGL's view matrix, column-major; its camera has y up and z backward, an optical frame y down and z forward."""
    rotation = (rotation_matrix(world_from_optical.orientation) * [1.0, -1.0, -1.0]).T
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = -rotation @ np.array(world_from_optical.position)
    return [float(value) for value in matrix.T.ravel()]
