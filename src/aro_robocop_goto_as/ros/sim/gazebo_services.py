"""Gazebo's services, for code that calls them: /gazebo/pause_physics, get_model_state, set_model_state, ...

What is not simulated answers with success false, so that a client that waits for it does not wait forever.
A single robot has its model's name, as with Gazebo's spawn_model; several robots have their own names.
"""

from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy
from gazebo_msgs import srv
from gazebo_msgs.msg import ModelState
from std_msgs.msg import Header
from std_srvs.srv import Empty, EmptyResponse

from ...errors import FrameError, PlaceError, WorldError
from ...geometry import STANDSTILL, compose3
from ...simulation.simulation import Simulation
from ...world.edit import with_model_at
from .. import convert
from .gazebo_property_services import GazeboProperties, serve
from .gazebo_topics import State, models, relative, state_of
from .world_services import WorldServices

PUSHED = "only /cmd_vel, the wheels' motors and contacts move a robot, and the world's models stand still"
REFUSED: Dict[str, Tuple[Any, str]] = {  # service: its type, the reason
    "apply_body_wrench": (srv.ApplyBodyWrench, f"forces are not simulated: {PUSHED}"),
    "apply_joint_effort": (srv.ApplyJointEffort, f"efforts are not simulated: {PUSHED}"),
    "get_link_properties": (srv.GetLinkProperties, "masses of links are not kept; a robot's are in /robot_description"),
    "set_joint_properties": (srv.SetJointProperties, "joints are as in the robot's URDF"),
    "set_link_properties": (srv.SetLinkProperties, "links are as in the robot's URDF and the world's file"),
    "set_link_state": (
        srv.SetLinkState,
        "links do not move by themselves; /gazebo/set_model_state moves a whole model",
    ),
    "set_model_configuration": (
        srv.SetModelConfiguration,
        "joints cannot be set: wheels turn as the robot drives, and the world's models have no joints that move",
    ),
}


class GazeboServices:
    """Every request is carried out by the simulation's owner, between two steps, or refused with success false."""

    def __init__(
        self,
        simulation: Simulation,
        world_services: Optional[WorldServices],
        refusal: str = "",
        set_factor: Optional[Callable[[float], None]] = None,
    ) -> None:
        """Without world services pausing and resetting do nothing, and other changes are refused with this reason.

        set_factor: changes the real-time factor
        """
        self._simulation = simulation
        self._simulator = simulation.simulator
        self._world_services = world_services
        self._refusal = refusal
        self._names = [robot.name or robot.model.name for robot in simulation.simulator.robots]
        self._serve_empty("pause_physics", lambda: simulation.set_paused(True))
        self._serve_empty("unpause_physics", lambda: simulation.set_paused(False))
        # Gazebo's reset_simulation also sets time back to zero: here the parameter ~reset_time decides about that.
        self._serve_empty("reset_simulation", simulation.reset)
        self._serve_empty("reset_world", simulation.reset)
        serve(simulation, "get_model_state", srv.GetModelState, self._get_model_state)
        serve(simulation, "set_model_state", srv.SetModelState, lambda asked: self._set_model_state(asked.model_state))
        serve(simulation, "get_world_properties", srv.GetWorldProperties, self._get_world_properties)
        rospy.Service("/gazebo/spawn_sdf_model", srv.SpawnModel, self._on_spawn)
        rospy.Service("/gazebo/spawn_urdf_model", srv.SpawnModel, self._on_spawn)
        rospy.Service("/gazebo/delete_model", srv.DeleteModel, self._on_delete)
        rospy.Service("/gazebo/delete_light", srv.DeleteLight, _delete_light)
        GazeboProperties(simulation, set_factor, refusal)
        for name, (kind, reason) in REFUSED.items():
            rospy.Service(f"/gazebo/{name}", kind, _refuser(name, reason))
        # Neither wrenches nor efforts are ever applied, so there is nothing to clear.
        rospy.Service("/gazebo/clear_body_wrenches", srv.BodyRequest, lambda _: [])
        rospy.Service("/gazebo/clear_joint_forces", srv.JointRequest, lambda _: [])
        if world_services is not None:
            rospy.Subscriber("/gazebo/set_model_state", ModelState, self._on_model_state, queue_size=10)

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def respond(_request: Any) -> EmptyResponse:
            if self._world_services is not None:
                self._simulation.jobs.call(action)
            return EmptyResponse()

        rospy.Service(f"/gazebo/{name}", Empty, respond)

    def _changes(self) -> WorldServices:
        if self._world_services is None:
            raise WorldError(self._refusal)
        return self._world_services

    # -- in the owner's thread --

    def _state(self, name: str) -> State:
        """The state of a model or robot; FrameError if it does not exist. 'model::link' means its model here."""
        return state_of("model", name.partition("::")[0], models(self._simulator), self._simulator.world.ground)

    def _get_model_state(self, request: Any) -> Dict[str, Any]:
        reference = request.relative_entity_name
        pose, twist = relative(self._state(request.model_name), self._state(reference))
        return {
            "header": Header(0, convert.to_time(self._simulator.stamp_ns), reference or "world"),
            "pose": pose,
            "twist": twist,
            "success": True,
            "status_message": "GetModelState: got properties",
        }

    def _set_model_state(self, requested: ModelState) -> Tuple[bool, str]:
        _, reference, _ = self._state(requested.reference_frame)
        target = compose3(reference, convert.from_pose_msg_3d(requested.pose, True))
        self._changes()
        name, done = requested.model_name, "SetModelState: set model state done"
        if name not in self._names:
            self._simulation.change_world(lambda world: with_model_at(world, name, target))
            return True, done
        self._simulation.place(target.on_plane(), self._names.index(name))
        moving = convert.from_twist_msg(requested.twist) != STANDSTILL
        return True, done + ("; its twist is ignored, only /cmd_vel moves a robot" if moving else "")

    def _get_world_properties(self, _request: Any) -> Tuple[float, List[str], bool, bool, str]:
        names = [name for name, _, _ in models(self._simulator)]
        return self._simulator.time, names, False, True, "GetWorldProperties: got properties"

    # -- in rospy's threads, where models are read --

    def _on_model_state(self, message: ModelState) -> None:
        try:
            self._simulation.jobs.call(lambda: self._set_model_state(message))
        except (FrameError, PlaceError, WorldError) as error:
            rospy.logwarn_throttle(5.0, "/gazebo/set_model_state: %s", error)

    def _on_spawn(self, request: Any) -> Tuple[bool, str]:
        try:
            _, reference, _ = self._simulation.jobs.call(lambda: self._state(request.reference_frame))
            changes = self._changes()
            if request.model_name in self._names:
                raise WorldError(f"model name [{request.model_name}] is already used by a robot")
            pose = compose3(reference, convert.from_pose_msg_3d(request.initial_pose, True))
            return True, f"SpawnModel: {changes.spawn(request.model_name, request.model_xml, '', pose)}"
        except (FrameError, WorldError) as error:
            return False, f"SpawnModel: {error}"

    def _on_delete(self, request: Any) -> Tuple[bool, str]:
        name = request.model_name
        try:
            if name in self._names:
                raise WorldError(f"[{name}] is a robot; robots cannot be deleted")
            return True, f"DeleteModel: {self._changes().delete(name)}"
        except WorldError as error:
            return False, f"DeleteModel: {error}"


def _delete_light(request: Any) -> Tuple[bool, str]:
    return True, f"there is no light {request.light_name!r} to delete: this simulator has none"


def _refuser(name: str, reason: str) -> Callable[[Any], Dict[str, Any]]:
    return lambda _request: {"success": False, "status_message": f"{name}: {reason}"}
