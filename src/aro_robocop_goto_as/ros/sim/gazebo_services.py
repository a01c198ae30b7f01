"""Gazebo's services that lab code calls: /gazebo/pause_physics, get_model_state, set_model_state, ...

A single robot has its model's name, as with Gazebo's spawn_model; several robots have their own names.
"""

from typing import Any, Callable, Dict, Optional, Tuple

import rospy
from gazebo_msgs import srv
from gazebo_msgs.msg import ModelState
from geometry_msgs.msg import Pose
from std_msgs.msg import Header
from std_srvs.srv import Empty, EmptyResponse

from ...errors import WorldError
from ...geometry import STANDSTILL, Pose3D, compose3
from ...simulation.simulator import Simulator
from ...world.edit import with_model_at
from .. import convert
from .gazebo_topics import State, models, raised, relative, robot_names, state_of
from .services import REFUSALS, Offer, SimulatorServices, serve

Fields = Dict[str, Any]  # of a response


class GazeboServices:
    """Every request is carried out by the simulation thread, between two steps, or refused with success false."""

    def __init__(
        self,
        simulator: Simulator,
        call: Callable[[Callable[[], Any]], Any],
        services: Optional[SimulatorServices],
        refusal: str = "",
        offer: Offer = rospy.Service,
    ) -> None:
        """`call`: has the simulation thread run a function, and returns its result.

        Without the simulator's services pausing and resetting do nothing; changes are refused with this reason.
        """
        self._simulator, self._call, self._offer = simulator, call, offer
        self._services, self._refusal = services, refusal
        self._names = robot_names(simulator)
        self._serve_empty("pause_physics", lambda: self._require_services().set_paused(True))
        self._serve_empty("unpause_physics", lambda: self._require_services().set_paused(False))
        # Unlike Gazebo's, these leave models that were moved, added or deleted as they are, and time goes on.
        self._serve_empty("reset_simulation", simulator.reset)
        self._serve_empty("reset_world", simulator.reset)
        for name, kind, answer in (
            ("get_model_state", srv.GetModelState, self._model_state),
            ("get_world_properties", srv.GetWorldProperties, self._world_properties),
            ("set_model_state", srv.SetModelState, lambda request: self._set_model_state(request.model_state)),
        ):
            serve(f"/gazebo/{name}", kind, self._in_simulation_thread(answer), "status_message", offer=offer)
        serve("/gazebo/spawn_sdf_model", srv.SpawnModel, self._spawn, "status_message", "SpawnModel: ", offer)
        serve("/gazebo/delete_model", srv.DeleteModel, self._delete, "status_message", "DeleteModel: ", offer)
        offer("/gazebo/delete_light", srv.DeleteLight, _delete_light)
        if services is not None:
            rospy.Subscriber("/gazebo/set_model_state", ModelState, self._on_model_state, queue_size=10)

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def respond(_request: Any) -> EmptyResponse:
            if self._services is not None:
                self._call(action)
            return EmptyResponse()

        self._offer(f"/gazebo/{name}", Empty, respond)

    def _in_simulation_thread(self, answer: Callable[[Any], Fields]) -> Callable[[Any], Fields]:
        return lambda request: self._call(lambda: answer(request))

    def _require_services(self) -> SimulatorServices:
        if self._services is None:
            raise WorldError(self._refusal)
        return self._services

    # -- in the simulation thread --

    def _model(self, name: str) -> State:
        """The state of a model or robot; FrameError if it does not exist. 'model::link' means its model here."""
        return state_of(name.partition("::")[0], models(self._simulator))

    def _model_state(self, request: Any) -> Fields:
        reference = request.relative_entity_name
        pose, twist = relative(self._model(request.model_name), self._model(reference))
        header = Header(0, convert.to_time(self._simulator.stamp_ns), reference or "world")
        return {"header": header, "pose": pose, "twist": twist, "status_message": "GetModelState: got properties"}

    def _world_properties(self, _request: Any) -> Fields:
        names = [name for name, _, _ in models(self._simulator)]
        text = "GetWorldProperties: got properties"
        return {"sim_time": self._simulator.time, "model_names": names, "status_message": text}

    def _in_world(self, pose: Pose, reference: str) -> Pose3D:
        """A pose in the simulator's world, from a pose that is relative to a model or to Gazebo's world."""
        _, origin, _ = self._model(reference)
        target = compose3(origin, convert.from_pose_msg_3d(pose))
        return raised(target, -self._simulator.world.ground)

    def _set_model_state(self, requested: ModelState) -> Fields:
        target = self._in_world(requested.pose, requested.reference_frame)
        self._require_services()
        name, done = requested.model_name, "SetModelState: set model state done"
        if name not in self._names:
            self._model(name)  # an error lists robots as well
            self._simulator.change_world(with_model_at(self._simulator.world, name, target))
            return {"status_message": done}
        robot, pose = self._names.index(name), target.on_plane()
        self._simulator.require_room(pose, robot)
        self._simulator.place(pose, robot)
        moving = convert.from_twist_msg(requested.twist) != STANDSTILL
        ignored = "; its twist is ignored, only /cmd_vel moves a robot" if moving else ""
        return {"status_message": done + ignored}

    # -- in rospy's threads, where models are read --

    def _on_model_state(self, message: ModelState) -> None:
        try:
            self._call(lambda: self._set_model_state(message))
        except REFUSALS as error:
            rospy.logwarn_throttle(5.0, "/gazebo/set_model_state: %s", error)

    def _spawn(self, request: Any) -> Fields:
        pose = self._call(lambda: self._in_world(request.initial_pose, request.reference_frame))
        services = self._require_services()
        if request.model_name in self._names:
            raise WorldError(f"model name [{request.model_name}] is already used by a robot")
        return {"status_message": "SpawnModel: " + services.spawn(request.model_name, request.model_xml, "", pose)}

    def _delete(self, request: Any) -> Fields:
        if request.model_name in self._names:
            raise WorldError(f"[{request.model_name}] is a robot; robots cannot be deleted")
        return {"status_message": "DeleteModel: " + self._require_services().delete(request.model_name)}


def _delete_light(request: Any) -> Tuple[bool, str]:
    return True, f"there is no light {request.light_name!r} to delete: this simulator has none"
