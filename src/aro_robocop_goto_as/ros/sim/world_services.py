"""Services that change the world while it runs: spawn_model, delete_model, move_model."""

from typing import Any, Callable, Dict

import rospy

from aro_robocop_goto_as.srv import DeleteModel, MoveModel, SpawnModel

from ...errors import FrameError, PlaceError, WorldError
from ...geometry import Pose3D
from ...simulation.simulation import Simulation
from ...world.edit import requested_model, with_model, with_model_at, without_model
from ...world.model import World
from .. import convert


def serve(
    name: str, kind: Any, answer: Callable[[Any], Dict[str, Any]], text: str = "message", begin: str = ""
) -> None:
    """Offer a service that answers with success false, and the reason, what is refused.

    answer: request -> the other fields of the response; text: the field with the reason, which begins with `begin`
    """

    def respond(request: Any) -> Dict[str, Any]:
        try:
            return {"success": True, **answer(request)}
        except (FrameError, PlaceError, WorldError) as error:
            return {"success": False, text: f"{begin}{error}"}

    rospy.Service(name, kind, respond)


class WorldServices:
    """Files are read in the service's thread; the world is changed in the owner's, between two steps."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        serve("~spawn_model", SpawnModel, lambda r: {"message": self.spawn(r.name, r.xml, r.file, _pose_of(r))})
        serve("~delete_model", DeleteModel, lambda r: {"message": self.delete(r.name)})
        serve("~move_model", MoveModel, lambda r: {"message": self.move(r.name, _pose_of(r))})

    def _change(self, edit: Callable[[World], World]) -> None:
        self._simulation.jobs.call(lambda: self._simulation.change_world(edit))

    def spawn(self, name: str, xml: str, file: str, pose: Pose3D) -> str:
        """Add a model, as requested_model reads it; returns what was done. WorldError where that is not possible."""
        model = requested_model(name, xml, file, pose, self._simulation.simulator.world.path)
        self._change(lambda world: with_model(world, model))
        ignored = f"; ignored: {', '.join(model.ignored)}" if model.ignored else ""
        differs = f"; different: {', '.join(model.approximated)}" if model.approximated else ""
        return f"model '{model.name}' with {len(model.obstacles)} collisions{ignored}{differs}"

    def delete(self, name: str) -> str:
        """Remove a model; returns what was done. WorldError if there is none of that name."""
        self._change(lambda world: without_model(world, name))
        return f"model '{name}' deleted"

    def move(self, name: str, pose: Pose3D) -> str:
        """Move a model; returns what was done. WorldError if there is none of that name."""
        self._change(lambda world: with_model_at(world, name, pose))
        return "model '{}' at x {:.3f} y {:.3f} z {:.3f}".format(name, *pose.position)


def _pose_of(request: Any) -> Pose3D:
    return convert.from_pose_msg_3d(request.pose, unset_is_level=True)
