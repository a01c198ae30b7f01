"""Gazebo's services, for code that calls them: /gazebo/pause_physics, get_model_state, set_model_state, ...

A lone robot goes by its model's name, as Gazebo's spawn_model has it; of many, each by its own.
"""

from typing import TYPE_CHECKING, Any, Callable, List, Type, TypeVar

import rospy
from gazebo_msgs.srv import (
    DeleteLight,
    DeleteLightResponse,
    GetModelState,
    GetModelStateRequest,
    GetModelStateResponse,
    GetWorldProperties,
    GetWorldPropertiesResponse,
    SetModelState,
    SetModelStateRequest,
    SetModelStateResponse,
)
from geometry_msgs.msg import Pose
from std_srvs.srv import Empty, EmptyResponse

from ..errors import FrameError
from ..geometry import STANDSTILL, Pose2D, compose, inverse
from . import convert

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
        rospy.Service("/gazebo/delete_light", DeleteLight, lambda request: DeleteLightResponse(
            True, f"there is no light {request.light_name!r} to delete: this simulator has none"))

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def serve(_request: Any) -> EmptyResponse:
            self.node.in_loop(action)
            return EmptyResponse()

        rospy.Service(f"/gazebo/{name}", Empty, serve)

    # -- poses, in the loop's thread --

    def _robot(self, name: str) -> int:
        if name not in self.names:
            raise FrameError(f"model [{name}] does not exist; there are: {', '.join(self.names)}")
        return self.names.index(name)

    def _world_from(self, name: str) -> Pose2D:
        """Where an entity stands; FrameError for one that does not exist. 'model::link' is its model here."""
        if name in WORLD:
            return Pose2D()
        return self.node.sim.world_from_base(self._robot(name.partition("::")[0]))

    def _on_get_model_state(self, request: GetModelStateRequest) -> GetModelStateResponse:
        def read() -> GetModelStateResponse:
            sim = self.node.sim
            robot, reference = self._robot(request.model_name), self._world_from(request.relative_entity_name)
            response = GetModelStateResponse(success=True, status_message="GetModelState: got properties")
            response.header.stamp = convert.to_time(sim.stamp_ns)
            response.header.frame_id = request.relative_entity_name or "world"
            response.pose = convert.to_pose_msg(compose(inverse(reference), sim.world_from_base(robot)))
            response.twist = convert.to_twist_msg(sim.velocity(robot))
            return response

        return self._answer(read, GetModelStateResponse)

    def _on_set_model_state(self, request: SetModelStateRequest) -> SetModelStateResponse:
        wanted = request.model_state

        def write() -> SetModelStateResponse:
            robot, reference = self._robot(wanted.model_name), self._world_from(wanted.reference_frame)
            target = convert.to_pose_msg(compose(reference, convert.from_pose_msg(_upright(wanted.pose))))
            self.node.place(robot, self.node.p.world_frame, target)
            moving = convert.from_twist_msg(wanted.twist) != STANDSTILL
            note = "; its twist is left out, only /cmd_vel moves a robot" if moving else ""
            return SetModelStateResponse(True, "SetModelState: set model state done" + note)

        return self._answer(write, SetModelStateResponse)

    def _on_get_world_properties(self, _request: Any) -> GetWorldPropertiesResponse:
        def read() -> GetWorldPropertiesResponse:
            return GetWorldPropertiesResponse(self.node.sim.time, self._model_names(), False, True,
                                              "GetWorldProperties: got properties")

        return self._answer(read, GetWorldPropertiesResponse)

    def _model_names(self) -> List[str]:
        models = [obstacle.name.split("/")[0] for obstacle in self.node.sim.world.obstacles]
        return list(dict.fromkeys(models)) + self.names

    def _answer(self, action: Callable[[], Response], kind: Type[Response]) -> Response:
        try:
            return self.node.in_loop(action)
        except FrameError as error:
            return kind(success=False, status_message=str(error))


def _upright(pose: Pose) -> Pose:
    """A pose whose quaternion nobody filled in, all zeros, is one that is not turned."""
    q = pose.orientation
    if (q.x, q.y, q.z, q.w) == (0.0, 0.0, 0.0, 0.0):
        q.w = 1.0
    return pose
