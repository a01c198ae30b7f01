"""Gazebo's services, for code that calls them: /gazebo/pause_physics, get_model_state, set_model_state, ...

A single robot has its model's name, as with Gazebo's spawn_model; several robots have their own names.
"""

from typing import Any, Callable, List, TypeVar

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

from ...errors import FrameError, PlaceError, WorldError
from ...geometry import STANDSTILL, Pose2D, Pose3D, compose3, inverse3, lifted
from ...simulation.loop import SimulationLoop
from ...world.edit import with_model_at
from .. import convert
from .world_services import WorldServices, from_pose

WORLD_FRAMES = ("", "world", "map")  # names of the frame that Gazebo's poses are in

Response = TypeVar("Response")


class GazeboControl:
    """What Gazebo's services may change; the judge replaces it by one that refuses."""

    def __init__(self, loop: SimulationLoop, world_services: WorldServices) -> None:
        self._loop = loop
        self._world_services = world_services

    # -- called in the loop's thread --

    def set_paused(self, paused: bool) -> None:
        """Pause or resume simulated time."""
        self._loop.set_paused(paused)

    def reset(self) -> None:
        """Robots to their spawn poses."""
        self._loop.reset()

    def place(self, robot: int, pose: Pose2D) -> None:
        """Place a robot; PlaceError if something is there."""
        self._loop.place_with_room(pose, robot)

    def move(self, model: str, pose: Pose3D) -> None:
        """Move a model of the world."""
        self._loop.change_world(lambda world: with_model_at(world, model, pose))

    # -- called in the service's thread, where files are read --

    def spawn(self, name: str, xml: str, pose: Pose3D) -> str:
        """Add a model to the world; returns what was done."""
        return self._world_services.spawn(name, xml, "", pose)

    def delete(self, name: str) -> str:
        """Remove a model from the world; returns what was done."""
        return self._world_services.delete(name)


class GazeboServices:
    """Every request is carried out in the loop's thread, between two steps, or refused with success false."""

    def __init__(self, loop: SimulationLoop, control: GazeboControl) -> None:
        self._loop = loop
        self._simulator = loop.simulator
        self._control = control
        self._names = [robot.name or robot.model.name for robot in loop.simulator.robots]
        self._serve_empty("pause_physics", lambda: control.set_paused(True))
        self._serve_empty("unpause_physics", lambda: control.set_paused(False))
        # Gazebo's reset_simulation also sets time back to zero: here the parameter ~reset_time decides about that.
        self._serve_empty("reset_simulation", control.reset)
        self._serve_empty("reset_world", control.reset)
        rospy.Service("/gazebo/get_model_state", GetModelState, self._on_get_model_state)
        rospy.Service("/gazebo/set_model_state", SetModelState, self._on_set_model_state)
        rospy.Service("/gazebo/get_world_properties", GetWorldProperties, self._on_get_world_properties)
        rospy.Service("/gazebo/spawn_sdf_model", SpawnModel, self._on_spawn)
        rospy.Service("/gazebo/delete_model", DeleteModel, self._on_delete)
        rospy.Service(
            "/gazebo/delete_light",
            DeleteLight,
            lambda request: DeleteLightResponse(
                True, f"there is no light {request.light_name!r} to delete: this simulator has none"
            ),
        )

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def serve(_request: Any) -> EmptyResponse:
            self._loop.call(action)
            return EmptyResponse()

        rospy.Service(f"/gazebo/{name}", Empty, serve)

    # -- poses, in the loop's thread --

    def _world_from(self, name: str) -> Pose3D:
        """Pose of a model or robot; FrameError if it does not exist. 'model::link' means its model here."""
        model = name.partition("::")[0]
        if model in WORLD_FRAMES:
            return Pose3D()
        if model in self._names:
            return lifted(self._simulator.world_from_footprint(self._names.index(model)))
        if model in self._simulator.world.models:
            return self._simulator.world.models[model]
        raise FrameError(f"model [{name}] does not exist; there are: {', '.join(self._model_names())}")

    def _model_names(self) -> List[str]:
        return [*self._simulator.world.models, *self._names]

    def _on_get_model_state(self, request: GetModelStateRequest) -> GetModelStateResponse:
        def read() -> GetModelStateResponse:
            name = request.model_name
            reference_from = inverse3(self._world_from(request.relative_entity_name))
            response = GetModelStateResponse(success=True, status_message="GetModelState: got properties")
            response.header.stamp = convert.to_time(self._simulator.stamp_ns)
            response.header.frame_id = request.relative_entity_name or "world"
            response.pose = convert.to_pose_msg(compose3(reference_from, self._world_from(name)))
            if name in self._names:
                response.twist = convert.to_twist_msg(self._simulator.velocity(self._names.index(name)))
            return response

        return self._answer(read, GetModelStateResponse)

    def _on_set_model_state(self, request: SetModelStateRequest) -> SetModelStateResponse:
        requested = request.model_state

        def write() -> SetModelStateResponse:
            target = compose3(self._world_from(requested.reference_frame), from_pose(requested.pose))
            if requested.model_name not in self._names:
                self._control.move(requested.model_name, target)
                return SetModelStateResponse(True, "SetModelState: set model state done")
            self._control.place(self._names.index(requested.model_name), target.on_plane())
            moving = convert.from_twist_msg(requested.twist) != STANDSTILL
            note = "; its twist is ignored, only /cmd_vel moves a robot" if moving else ""
            return SetModelStateResponse(True, "SetModelState: set model state done" + note)

        return self._answer(write, SetModelStateResponse)

    def _on_get_world_properties(self, _request: Any) -> GetWorldPropertiesResponse:
        def read() -> GetWorldPropertiesResponse:
            return GetWorldPropertiesResponse(
                self._simulator.time, self._model_names(), False, True, "GetWorldProperties: got properties"
            )

        return self._answer(read, GetWorldPropertiesResponse)

    def _answer(self, action: Callable[[], Response], kind: Callable[..., Response]) -> Response:
        try:
            return self._loop.call(action)
        except (FrameError, PlaceError, WorldError) as error:
            return kind(success=False, status_message=str(error))

    # -- models, read in the service's thread --

    def _on_spawn(self, request: SpawnModelRequest) -> SpawnModelResponse:
        try:
            reference = self._loop.call(lambda: self._world_from(request.reference_frame))
            if request.model_name in self._names:
                raise WorldError(f"model name [{request.model_name}] is already used by a robot")
            pose = compose3(reference, from_pose(request.initial_pose))
            done = self._control.spawn(request.model_name, request.model_xml, pose)
        except (FrameError, WorldError) as error:
            return SpawnModelResponse(False, f"SpawnModel: {error}")
        return SpawnModelResponse(True, f"SpawnModel: {done}")

    def _on_delete(self, request: DeleteModelRequest) -> DeleteModelResponse:
        if request.model_name in self._names:
            refusal = f"[{request.model_name}] is a robot; robots cannot be deleted"
            return DeleteModelResponse(False, f"DeleteModel: {refusal}")
        try:
            return DeleteModelResponse(True, f"DeleteModel: {self._control.delete(request.model_name)}")
        except WorldError as error:
            return DeleteModelResponse(False, f"DeleteModel: {error}")
