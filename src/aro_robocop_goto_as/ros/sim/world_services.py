"""Services that change the world while it runs: spawn_model, delete_model, move_model."""

import math
from typing import Any, Callable, Tuple

import rospy

from aro_robocop_goto_as.srv import (
    DeleteModel,
    DeleteModelRequest,
    DeleteModelResponse,
    MoveModel,
    MoveModelRequest,
    MoveModelResponse,
    SpawnModel,
    SpawnModelRequest,
    SpawnModelResponse,
)

from ...errors import WorldError
from ...geometry import FARTHEST, Pose3D
from ...simulation.loop import SimulationLoop
from ...world.edit import requested_model, with_model, with_model_at, without_model

QUATERNION_TOLERANCE = 1e-3  # of a quaternion's length


def from_pose(pose: Any) -> Pose3D:
    """geometry_msgs/Pose in space; a quaternion of zeros means level. WorldError if it is no pose."""
    position = (pose.position.x, pose.position.y, pose.position.z)
    q = pose.orientation
    x, y, z, w = (q.x, q.y, q.z, q.w) if any((q.x, q.y, q.z, q.w)) else (0.0, 0.0, 0.0, 1.0)
    length = math.hypot(math.hypot(x, y), math.hypot(z, w))
    if not all(abs(value) <= FARTHEST for value in position) or not abs(length - 1.0) <= QUATERNION_TOLERANCE:
        raise WorldError(
            f"pose {position}, quaternion {(x, y, z, w)}: expected numbers within +-{FARTHEST:g} "
            "and a quaternion of length 1"
        )
    return Pose3D(position, (x / length, y / length, z / length, w / length))


class WorldServices:
    """Files are read in the service's thread; the world is changed in the loop's, between two steps."""

    def __init__(self, loop: SimulationLoop) -> None:
        self._loop = loop
        rospy.Service("~spawn_model", SpawnModel, self._on_spawn)
        rospy.Service("~delete_model", DeleteModel, self._on_delete)
        rospy.Service("~move_model", MoveModel, self._on_move)

    def _on_spawn(self, request: SpawnModelRequest) -> SpawnModelResponse:
        return SpawnModelResponse(
            *_answer(lambda: self.spawn(request.name, request.xml, request.file, from_pose(request.pose)))
        )

    def _on_delete(self, request: DeleteModelRequest) -> DeleteModelResponse:
        return DeleteModelResponse(*_answer(lambda: self.delete(request.name)))

    def _on_move(self, request: MoveModelRequest) -> MoveModelResponse:
        return MoveModelResponse(*_answer(lambda: self.move(request.name, from_pose(request.pose))))

    def spawn(self, name: str, xml: str, file: str, pose: Pose3D) -> str:
        """Add a model, as requested_model reads it; returns what was done. WorldError where that is not possible."""
        model = requested_model(name, xml, file, pose, self._loop.simulator.world.path)
        self._loop.call(lambda: self._loop.change_world(lambda world: with_model(world, model)))
        ignored = f"; not simulated: {', '.join(model.ignored)}" if model.ignored else ""
        return f"model '{model.name}' with {len(model.obstacles)} collisions{ignored}"

    def delete(self, name: str) -> str:
        """Remove a model; returns what was done. WorldError if there is none of that name."""
        self._loop.call(lambda: self._loop.change_world(lambda world: without_model(world, name)))
        return f"model '{name}' deleted"

    def move(self, name: str, pose: Pose3D) -> str:
        """Move a model; returns what was done. WorldError if there is none of that name."""
        self._loop.call(lambda: self._loop.change_world(lambda world: with_model_at(world, name, pose)))
        return "model '{}' at x {:.3f} y {:.3f} z {:.3f}".format(name, *pose.position)


def _answer(action: Callable[[], str]) -> Tuple[bool, str]:
    try:
        return True, action()
    except WorldError as error:
        return False, str(error)
