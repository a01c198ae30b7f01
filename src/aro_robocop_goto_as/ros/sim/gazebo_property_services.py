"""Gazebo's services that tell the properties of links, joints, models and physics."""

from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy
from gazebo_msgs import srv
from gazebo_msgs.msg import LinkState
from geometry_msgs.msg import Vector3

from ...errors import FrameError, PlaceError, WorldError
from ...geometry import STANDARD_GRAVITY, STANDSTILL
from ...robot.model import WHEEL_JOINTS
from ...simulation.simulation import Simulation
from .. import convert
from .gazebo_topics import State, links, relative, state_of

SLOP = 1e-6  # [s] by which a time step may differ from the simulator's
GRAVITY_SLOP = 0.02  # [m/s^2]: Gazebo's worlds have 9.8 or 9.81


def serve(simulation: Simulation, name: str, kind: Any, answer: Callable[[Any], Any]) -> None:
    """Offer a service whose requests the simulation's owner answers between two steps, or refuses with success false.

    answer: request -> the response's fields, as rospy takes them from a service's function
    """

    def respond(request: Any) -> Any:
        try:
            return simulation.jobs.call(lambda: answer(request))
        except (FrameError, PlaceError, WorldError) as error:
            return {"success": False, "status_message": str(error)}

    rospy.Service(f"/gazebo/{name}", kind, respond)


class GazeboProperties:
    """What is known of links, joints and physics."""

    def __init__(self, simulation: Simulation, set_factor: Optional[Callable[[float], None]], refusal: str) -> None:
        """set_factor: changes the real-time factor; without it, that is refused with this reason."""
        self._simulation = simulation
        self._simulator = simulation.simulator
        self._set_factor, self._refusal = set_factor, refusal
        serve(simulation, "get_joint_properties", srv.GetJointProperties, self._get_joint_properties)
        serve(simulation, "get_link_state", srv.GetLinkState, self._get_link_state)
        serve(simulation, "get_model_properties", srv.GetModelProperties, self._get_model_properties)
        serve(simulation, "get_physics_properties", srv.GetPhysicsProperties, self._get_physics_properties)
        rospy.Service("/gazebo/set_physics_properties", srv.SetPhysicsProperties, self._on_set_physics_properties)

    # -- in the owner's thread --

    def _link(self, name: str) -> State:
        """The state of a link or of the world; FrameError if there is no such link.

        The links of the world's models are not kept apart: each is where its model is, as on /gazebo/link_states.
        """
        known = links(self._simulator)
        model = name.partition("::")[0]
        if model != name and model in self._simulator.world.models:
            known.append((name, self._simulator.world.models[model], convert.to_twist_msg(STANDSTILL)))
        return state_of("link", name, known, self._simulator.world.ground)

    def _get_link_state(self, request: Any) -> Tuple[LinkState, bool, str]:
        pose, twist = relative(self._link(request.link_name), self._link(request.reference_frame))
        state = LinkState(request.link_name, pose, twist, request.reference_frame or "world")
        return state, True, "GetLinkState: got state"

    def _get_model_properties(self, request: Any) -> Dict[str, Any]:
        name, joints = request.model_name, []
        nested: List[str] = []
        is_static = name in self._simulator.world.models
        if is_static:
            # MODEL/LINK/COLLISION, or MODEL/NESTED/LINK/COLLISION
            parts = [o.name.split("/") for o in self._simulator.world.obstacles if o.name.startswith(name + "/")]
            bodies = _each([part[1] for part in parts if len(part) == 3])
            geoms = [part[2] for part in parts if len(part) == 3]
            nested = _each([part[1] for part in parts if len(part) > 3])
        else:
            collisions = self._simulator.robots[self._robot(name)].model.collisions
            bodies = [link.rpartition("::")[2] for link, _, _ in links(self._simulator) if link.startswith(name + "::")]
            geoms = [obstacle.name for obstacle in collisions]
            joints = list(WHEEL_JOINTS)
        return {
            "canonical_body_name": bodies[0] if bodies else "",
            "body_names": bodies,
            "geom_names": geoms,
            "joint_names": joints,
            "child_model_names": nested,
            "is_static": is_static,
            "success": True,
            "status_message": "GetModelProperties: got properties",
        }

    def _get_joint_properties(self, request: Any) -> Dict[str, Any]:
        robot, _, joint = request.joint_name.rpartition("::")
        if joint not in WHEEL_JOINTS:
            raise FrameError(f"joint [{request.joint_name}] does not exist; there are: {', '.join(WHEEL_JOINTS)}")
        self._simulator.engine.update_fleet()
        state = self._simulator.fleet.state(self._robot(robot) if robot else 0)
        side = WHEEL_JOINTS.index(joint)
        return {
            "type": srv.GetJointPropertiesResponse.REVOLUTE,  # as gazebo_ros says of every joint
            "damping": [0.0],
            "position": [state.wheel_angles[side]],
            "rate": [state.wheel_speeds[side]],
            "success": True,
            "status_message": "GetJointProperties: got properties",
        }

    def _robot(self, name: str) -> int:
        """A robot's index; FrameError if there is none of that name."""
        names = [robot.name or robot.model.name for robot in self._simulator.robots]
        if name not in names:
            known = ", ".join([*self._simulator.world.models, *names])
            raise FrameError(f"model [{name}] does not exist; there are: {known}")
        return names.index(name)

    def _get_physics_properties(self, _request: Any) -> Dict[str, Any]:
        rate, time = self._simulator.rate, self._simulation.time_control
        return {
            "time_step": 1.0 / rate,
            "pause": time.paused,
            "max_update_rate": rate * time.pacer.factor,  # in Gazebo, too, 0 is as fast as possible
            "gravity": Vector3(0.0, 0.0, -STANDARD_GRAVITY),
            "success": True,
            "status_message": "GetPhysicsProperties: got properties",
        }

    # -- in the service's thread --

    def _on_set_physics_properties(self, request: Any) -> Tuple[bool, str]:
        """Only how fast simulated time passes can be changed."""
        refusal = self._refusal if self._set_factor is None else self._refused(request)
        if self._set_factor is None or refusal:
            return False, f"SetPhysicsProperties: {refusal}"
        self._set_factor(request.max_update_rate / self._simulator.rate)
        return True, "SetPhysicsProperties: max_update_rate set; the rest is as it was"

    def _refused(self, request: Any) -> str:
        """Why these physics are impossible; empty if they are not."""
        time_step, gravity = 1.0 / self._simulator.rate, request.gravity
        if not abs(request.time_step - time_step) <= SLOP:  # true for NaN
            return f"time_step is {time_step:g} s, by the parameter physics_rate; it cannot be changed"
        differences = (gravity.x, gravity.y, gravity.z + STANDARD_GRAVITY)
        if not all(abs(difference) <= GRAVITY_SLOP for difference in differences):
            return f"gravity is {-STANDARD_GRAVITY:g} m/s^2 along z; it cannot be changed"
        if not 0.0 <= request.max_update_rate < 1e9:
            return f"max_update_rate is {request.max_update_rate:g}, expected a number of 0 or more"
        return ""


def _each(names: List[str]) -> List[str]:
    """Names in their order, each once."""
    return list(dict.fromkeys(names))
