"""World + robots' poses -> images, by Bullet's software renderer in a Bullet world of its own, without physics.

So both drives have cameras, and what is rendered never changes what is simulated.
"""

from typing import List, Sequence, Tuple

import numpy as np
import pybullet

from .bullet_shapes import load_urdf, look_of
from .geometry import Pose3D, rotation_matrix
from .physics import FLOOR
from .robot import RobotModel
from .sensors.camera import CameraImage, CameraSpec, depth_of, projection
from .shapes import Obstacle, World

OUT_OF_SIGHT = (0.0, 0.0, -1e4)  # [m] where a robot is put while its own camera looks
SKY = np.array([178, 200, 222], np.uint8)


class Renderer:
    """Images of one world with its robots, which are shown where they are but without turning their wheels."""

    def __init__(self, world: World, models: Sequence[RobotModel]) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._moving: List[Tuple[int, Obstacle]] = []
        others = [it for it in world.obstacles if (it.pose, it.geometry) != (FLOOR.pose, FLOOR.geometry)]
        for obstacle in (FLOOR, *others):
            for look in look_of(obstacle.geometry, self._client):
                body = pybullet.createMultiBody(0.0, -1, look, obstacle.pose.position, obstacle.pose.orientation,
                                                physicsClientId=self._client)
                if obstacle.motion is not None:
                    self._moving.append((body, obstacle))
        self._robots = [load_urdf(model, self._client) for model in models]

    def render(self, spec: CameraSpec, world_from_optical: Pose3D, robot: int, world_from_bases: Sequence[Pose3D],
               time: float) -> CameraImage:
        """What the camera of a robot sees of all but that robot, at a time [s]."""
        for body, obstacle in self._moving:
            self._put(body, obstacle.at(time))
        for index, (body, pose) in enumerate(zip(self._robots, world_from_bases)):
            self._put(body, Pose3D(OUT_OF_SIGHT) if index == robot else pose)
        _, _, pixels, buffer, _ = pybullet.getCameraImage(
            spec.width, spec.height, _view(world_from_optical), projection(spec), shadow=0,
            renderer=pybullet.ER_TINY_RENDERER, flags=pybullet.ER_NO_SEGMENTATION_MASK, physicsClientId=self._client)
        depth = depth_of(np.reshape(buffer, (spec.height, spec.width)), spec)
        rgb = np.reshape(np.asarray(pixels, np.uint8), (spec.height, spec.width, 4))[..., :3]
        return CameraImage(np.where(np.isfinite(depth)[..., None], rgb, SKY), depth)

    def _put(self, body: int, pose: Pose3D) -> None:
        pybullet.resetBasePositionAndOrientation(body, pose.position, pose.orientation, physicsClientId=self._client)

    def close(self) -> None:
        """Give Bullet's memory back."""
        pybullet.disconnect(physicsClientId=self._client)


def _view(world_from_optical: Pose3D) -> List[float]:
    """OpenGL's view matrix, column by column: its camera's y is up and z back, an optical frame's down and ahead."""
    rotation = (rotation_matrix(world_from_optical.orientation) * [1.0, -1.0, -1.0]).T
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = -rotation @ np.array(world_from_optical.position)
    return [float(value) for value in matrix.T.ravel()]
