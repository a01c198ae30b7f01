"""Gazebo's services, for code that calls them: /gazebo/pause_physics, get_model_state, set_model_state, ...

A lone robot goes by its model's name, as Gazebo's spawn_model has it; of many, each by its own.
"""

from typing import TYPE_CHECKING, Any, Callable, List, Type, TypeVar

import rospy
from gazebo_msgs.srv import (
    DeleteLight,
    DeleteLightResponse,
    DeleteModel,
    DeleteModelRequest,
    DeleteModelResponse,
    GetModelState,
    GetModelStateRequest,
    GetModelStateResponse,
    GetWorldProperties,
    GetWorldPropertiesResponse,
    SetModelState,
    SetModelStateRequest,
    SetModelStateResponse,
    SpawnModel,
    SpawnModelRequest,
    SpawnModelResponse,
)
from std_srvs.srv import Empty, EmptyResponse

from ..errors import FrameError, WorldError
from ..geometry import STANDSTILL, Pose3D, compose3, inverse3, lifted
from . import convert
from .world_control import from_pose

if TYPE_CHECKING:
    from .sim import SimNode

WORLD = ("", "world", "map")  # names of the frame that Gazebo's poses are in

Response = TypeVar("Response")


class GazeboServices:
    """Every request is carried out in the loop's thread, between two steps, or refused with success false."""

    def __init__(self, node: "SimNode") -> None:
        self.node = node
        self.names = [robot.name or robot.model.name for robot in node.sim.robots]
        control = node.control
        self._serve_empty("pause_physics", lambda: control.set_paused(True))
        self._serve_empty("unpause_physics", lambda: control.set_paused(False))
        # Gazebo's differ in that reset_simulation sets time back as well: here that is up to ~reset_time.
        self._serve_empty("reset_simulation", lambda: control.reset(0))
        self._serve_empty("reset_world", lambda: control.reset(0))
        rospy.Service("/gazebo/get_model_state", GetModelState, self._on_get_model_state)
        rospy.Service("/gazebo/set_model_state", SetModelState, self._on_set_model_state)
        rospy.Service("/gazebo/get_world_properties", GetWorldProperties, self._on_get_world_properties)
        rospy.Service("/gazebo/spawn_sdf_model", SpawnModel, self._on_spawn)
        rospy.Service("/gazebo/delete_model", DeleteModel, self._on_delete)
        rospy.Service("/gazebo/delete_light", DeleteLight, lambda request: DeleteLightResponse(
            True, f"there is no light {request.light_name!r} to delete: this simulator has none"))

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def serve(_request: Any) -> EmptyResponse:
            self.node.in_loop(action)
            return EmptyResponse()

        rospy.Service(f"/gazebo/{name}", Empty, serve)

    # -- poses, in the loop's thread --

    def _world_from(self, name: str) -> Pose3D:
        """Where an entity stands; FrameError for one that does not exist. 'model::link' is its model here."""
        model = name.partition("::")[0]
        sim = self.node.sim
        if model in WORLD:
            return Pose3D()
        if model in self.names:
            return lifted(sim.world_from_base(self.names.index(model)))
        if model in sim.world.models:
            return sim.world.models[model]
        raise FrameError(f"model [{name}] does not exist; there are: {', '.join(self._model_names())}")

    def _model_names(self) -> List[str]:
        return [*self.node.sim.world.models, *self.names]

    def _on_get_model_state(self, request: GetModelStateRequest) -> GetModelStateResponse:
        def read() -> GetModelStateResponse:
            sim, name = self.node.sim, request.model_name
            reference_from = inverse3(self._world_from(request.relative_entity_name))
            response = GetModelStateResponse(success=True, status_message="GetModelState: got properties")
            response.header.stamp = convert.to_time(sim.stamp_ns)
            response.header.frame_id = request.relative_entity_name or "world"
            response.pose = convert.to_pose_msg(compose3(reference_from, self._world_from(name)))
            if name in self.names:
                response.twist = convert.to_twist_msg(sim.velocity(self.names.index(name)))
            return response

        return self._answer(read, GetModelStateResponse)

    def _on_set_model_state(self, request: SetModelStateRequest) -> SetModelStateResponse:
        wanted = request.model_state

        def write() -> SetModelStateResponse:
            target = compose3(self._world_from(wanted.reference_frame), from_pose(wanted.pose))
            if wanted.model_name not in self.names:
                self.node.world_control.set_down(wanted.model_name, target)
                return SetModelStateResponse(True, "SetModelState: set model state done")
            robot = self.names.index(wanted.model_name)
            self.node.place(robot, self.node.p.world_frame, convert.to_pose_msg(lifted(target.on_plane())))
            moving = convert.from_twist_msg(wanted.twist) != STANDSTILL
            note = "; its twist is left out, only /cmd_vel moves a robot" if moving else ""
            return SetModelStateResponse(True, "SetModelState: set model state done" + note)

        return self._answer(write, SetModelStateResponse)

    def _on_get_world_properties(self, _request: Any) -> GetWorldPropertiesResponse:
        def read() -> GetWorldPropertiesResponse:
            return GetWorldPropertiesResponse(self.node.sim.time, self._model_names(), False, True,
                                              "GetWorldProperties: got properties")

        return self._answer(read, GetWorldPropertiesResponse)

    def _answer(self, action: Callable[[], Response], kind: Type[Response]) -> Response:
        try:
            return self.node.in_loop(action)
        except (FrameError, WorldError) as error:
            return kind(success=False, status_message=str(error))

    # -- models, read in the service's thread --

    def _on_spawn(self, request: SpawnModelRequest) -> SpawnModelResponse:
        try:
            reference = self.node.in_loop(lambda: self._world_from(request.reference_frame))
            if request.model_name in self.names:
                raise WorldError(f"model name [{request.model_name}] is taken, by a robot")
            pose = compose3(reference, from_pose(request.initial_pose))
            told = self.node.world_control.spawn(request.model_name, request.model_xml, "", pose)
        except (FrameError, WorldError) as error:
            return SpawnModelResponse(False, f"SpawnModel: {error}")
        return SpawnModelResponse(True, f"SpawnModel: {told}")

    def _on_delete(self, request: DeleteModelRequest) -> DeleteModelResponse:
        if request.model_name in self.names:
            return DeleteModelResponse(False, f"DeleteModel: [{request.model_name}] is a robot; robots stay")
        try:
            return DeleteModelResponse(True, f"DeleteModel: {self.node.world_control.delete(request.model_name)}")
        except WorldError as error:
            return DeleteModelResponse(False, f"DeleteModel: {error}")
