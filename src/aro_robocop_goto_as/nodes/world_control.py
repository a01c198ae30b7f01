"""Services that change the world while it runs: spawn_model, delete_model, move_model."""

import math
from typing import TYPE_CHECKING, Any, Callable, Tuple

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

from ..errors import WorldError
from ..geometry import Pose3D
from ..shapes import World
from ..spawns import FARTHEST
from ..world_edits import requested_model, with_model, with_model_at, without_model

if TYPE_CHECKING:
    from .sim import SimNode

UNIT = 1e-3  # how far from 1 the length of a quaternion may be


def from_pose(pose: Any) -> Pose3D:
    """geometry_msgs/Pose in space; zeros for a quaternion mean level. WorldError if it is no pose."""
    position = (pose.position.x, pose.position.y, pose.position.z)
    q = pose.orientation
    x, y, z, w = (q.x, q.y, q.z, q.w) if any((q.x, q.y, q.z, q.w)) else (0.0, 0.0, 0.0, 1.0)
    length = math.hypot(math.hypot(x, y), math.hypot(z, w))
    if not all(abs(value) <= FARTHEST for value in position) or not abs(length - 1.0) <= UNIT:
        raise WorldError(f"pose {position}, quaternion {(x, y, z, w)}: expected numbers within +-{FARTHEST:g} "
                         "and a quaternion of length 1")
    return Pose3D(position, (x / length, y / length, z / length, w / length))


class WorldControl:
    """Files are read in the service's thread; the world is changed in the loop's, between two steps."""

    def __init__(self, node: "SimNode") -> None:
        self.node = node
        rospy.Service("~spawn_model", SpawnModel, self._on_spawn)
        rospy.Service("~delete_model", DeleteModel, self._on_delete)
        rospy.Service("~move_model", MoveModel, self._on_move)

    def _on_spawn(self, request: SpawnModelRequest) -> SpawnModelResponse:
        return SpawnModelResponse(*self._answer(
            lambda: self.spawn(request.name, request.xml, request.file, from_pose(request.pose))))

    def _on_delete(self, request: DeleteModelRequest) -> DeleteModelResponse:
        return DeleteModelResponse(*self._answer(lambda: self.delete(request.name)))

    def _on_move(self, request: MoveModelRequest) -> MoveModelResponse:
        return MoveModelResponse(*self._answer(lambda: self.move(request.name, from_pose(request.pose))))

    @staticmethod
    def _answer(action: Callable[[], str]) -> Tuple[bool, str]:
        try:
            return True, action()
        except WorldError as error:
            return False, str(error)

    def spawn(self, name: str, xml: str, file: str, pose: Pose3D) -> str:
        """Put a model in, as requested_model reads it; what was done, in words. WorldError where it can't be."""
        model = requested_model(name, xml, file, pose)
        self._change(lambda world: with_model(world, model))
        told = f"; not simulated: {', '.join(model.ignored)}" if model.ignored else ""
        return f"model '{model.name}' with {len(model.obstacles)} collisions{told}"

    def delete(self, name: str) -> str:
        """Take a model out; what was done, in words. WorldError if there is none of that name."""
        self._change(lambda world: without_model(world, name))
        return f"model '{name}' deleted"

    def move(self, name: str, pose: Pose3D) -> str:
        """Set a model elsewhere; what was done, in words. WorldError if there is none of that name."""
        self.node.in_loop(lambda: self.set_down(name, pose))
        return "model '{}' at x {:.3f} y {:.3f} z {:.3f}".format(name, *pose.position)

    def set_down(self, name: str, pose: Pose3D) -> None:
        """`move`, for who is in the loop's thread already."""
        self.node.change_world(with_model_at(self.node.sim.world, name, pose))

    def _change(self, edit: Callable[[World], World]) -> None:
        def change() -> None:
            self.node.change_world(edit(self.node.sim.world))

        self.node.in_loop(change)
