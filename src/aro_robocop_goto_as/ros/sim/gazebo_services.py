"""Gazebo's services, for code that calls them: /gazebo/pause_physics, get_model_state, set_model_state, ...

What is not simulated answers with success false, so that a client that waits for it does not wait forever.
A single robot has its model's name, as with Gazebo's spawn_model; several robots have their own names.
"""

from typing import Any, Callable, Dict, Optional, Tuple

import rospy
from gazebo_msgs import srv
from gazebo_msgs.msg import ModelState
from geometry_msgs.msg import Pose
from std_srvs.srv import Empty, EmptyResponse

from ...errors import WorldError
from ...geometry import STANDARD_GRAVITY, STANDSTILL, Pose3D, compose3
from ...simulation.simulation import Simulation
from ...world.edit import with_model_at
from .. import convert
from .gazebo_property_services import GazeboProperties
from .gazebo_topics import raised, robot_names
from .services import REFUSALS, Services, serve

SLOP = 1e-6  # [s] by which a time step may differ from the simulator's
GRAVITY_SLOP = 0.02  # [m/s^2]: Gazebo's worlds have 9.8 or 9.81
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

    def __init__(self, simulation: Simulation, services: Optional[Services], refusal: str = "") -> None:
        """Without the simulator's services pausing and resetting do nothing; changes are refused with this reason."""
        self._simulation = simulation
        self._simulator = simulation.simulator
        self._services, self._refusal = services, refusal
        self._names = robot_names(simulation.simulator)
        self._properties = GazeboProperties(simulation)
        self._serve_empty("pause_physics", lambda: simulation.set_paused(True))
        self._serve_empty("unpause_physics", lambda: simulation.set_paused(False))
        # Gazebo's reset_simulation also sets time back to zero; here time goes on.
        self._serve_empty("reset_simulation", simulation.reset)
        self._serve_empty("reset_world", simulation.reset)
        self._serve_change("spawn_sdf_model", srv.SpawnModel, self._spawn)
        self._serve_change("spawn_urdf_model", srv.SpawnModel, self._spawn)
        self._serve_change("delete_model", srv.DeleteModel, self._delete)
        self._serve_change("set_physics_properties", srv.SetPhysicsProperties, self._set_physics_properties)
        serve("/gazebo/set_model_state", srv.SetModelState, self._on_set_model_state, "status_message")
        rospy.Service("/gazebo/delete_light", srv.DeleteLight, _delete_light)
        for name, (kind, reason) in REFUSED.items():
            rospy.Service(f"/gazebo/{name}", kind, _refuser(name, reason))
        # Neither wrenches nor efforts are ever applied, so there is nothing to clear.
        rospy.Service("/gazebo/clear_body_wrenches", srv.BodyRequest, lambda _: [])
        rospy.Service("/gazebo/clear_joint_forces", srv.JointRequest, lambda _: [])
        if services is not None:
            rospy.Subscriber("/gazebo/set_model_state", ModelState, self._on_model_state, queue_size=10)

    def _serve_empty(self, name: str, action: Callable[[], Any]) -> None:
        def respond(_request: Any) -> EmptyResponse:
            if self._services is not None:
                self._simulation.jobs.call(action)
            return EmptyResponse()

        rospy.Service(f"/gazebo/{name}", Empty, respond)

    def _serve_change(self, name: str, kind: Any, change: Callable[[Any], str]) -> None:
        """`change`: request -> what was done, which the response says after the name of its type."""
        begin, text = f"{kind.__name__}: ", "status_message"
        serve(f"/gazebo/{name}", kind, lambda request: {text: begin + change(request)}, text, begin)

    def _changes(self) -> Services:
        if self._services is None:
            raise WorldError(self._refusal)
        return self._services

    # -- in the owner's thread --

    def _in_world(self, pose: Pose, reference: str) -> Pose3D:
        """A pose in the simulator's world, of one that is relative to a model or to Gazebo's world."""
        _, origin, _ = self._properties.model(reference)
        target = compose3(origin, convert.from_pose_msg_3d(pose, unset_is_level=True))
        return raised(target, -self._simulator.world.ground)

    def _set_model_state(self, requested: ModelState) -> str:
        target = self._in_world(requested.pose, requested.reference_frame)
        self._changes()
        name, done = requested.model_name, "SetModelState: set model state done"
        if name not in self._names:
            self._simulation.change_world(lambda world: with_model_at(world, name, target))
            return done
        self._simulation.place(target.on_plane(), self._names.index(name))
        moving = convert.from_twist_msg(requested.twist) != STANDSTILL
        return done + ("; its twist is ignored, only /cmd_vel moves a robot" if moving else "")

    # -- in rospy's threads, where models are read --

    def _on_set_model_state(self, request: Any) -> Dict[str, str]:
        return {"status_message": self._simulation.jobs.call(lambda: self._set_model_state(request.model_state))}

    def _on_model_state(self, message: ModelState) -> None:
        try:
            self._simulation.jobs.call(lambda: self._set_model_state(message))
        except REFUSALS as error:
            rospy.logwarn_throttle(5.0, "/gazebo/set_model_state: %s", error)

    def _spawn(self, request: Any) -> str:
        pose = self._simulation.jobs.call(lambda: self._in_world(request.initial_pose, request.reference_frame))
        changes = self._changes()
        if request.model_name in self._names:
            raise WorldError(f"model name [{request.model_name}] is already used by a robot")
        return changes.spawn(request.model_name, request.model_xml, "", pose)

    def _delete(self, request: Any) -> str:
        if request.model_name in self._names:
            raise WorldError(f"[{request.model_name}] is a robot; robots cannot be deleted")
        return self._changes().delete(request.model_name)

    def _set_physics_properties(self, request: Any) -> str:
        """Only how fast simulated time passes can be changed."""
        changes, rate, gravity = self._changes(), self._simulator.rate, request.gravity
        if not abs(request.time_step - 1.0 / rate) <= SLOP:  # true for NaN
            raise WorldError(f"time_step is {1.0 / rate:g} s, by the parameter physics_rate; it cannot be changed")
        differences = (gravity.x, gravity.y, gravity.z + STANDARD_GRAVITY)
        if not all(abs(difference) <= GRAVITY_SLOP for difference in differences):
            raise WorldError(f"gravity is {-STANDARD_GRAVITY:g} m/s^2 along z; it cannot be changed")
        if not 0.0 <= request.max_update_rate < 1e9:
            raise WorldError(f"max_update_rate is {request.max_update_rate:g}, expected a number of 0 or more")
        changes.set_factor(request.max_update_rate / rate)
        return "max_update_rate set; the rest is as it was"


def _delete_light(request: Any) -> Tuple[bool, str]:
    return True, f"there is no light {request.light_name!r} to delete: this simulator has none"


def _refuser(name: str, reason: str) -> Callable[[Any], Dict[str, Any]]:
    return lambda _request: {"success": False, "status_message": f"{name}: {reason}"}
