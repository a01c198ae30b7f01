"""Gazebo's services that tell the states and properties of models, links, joints and physics."""

from typing import Any, Callable, Dict, List

from gazebo_msgs import srv
from gazebo_msgs.msg import LinkState
from geometry_msgs.msg import Vector3
from std_msgs.msg import Header

from ...errors import FrameError
from ...geometry import STANDARD_GRAVITY
from ...robot.model import WHEEL_JOINTS
from ...simulation.simulation import Simulation
from .. import convert
from .gazebo_topics import State, links, models, relative, robot_names, state_of
from .services import serve

Fields = Dict[str, Any]  # of a response


class GazeboProperties:
    """Every request is answered by the simulation's owner, between two steps."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._simulator = simulation.simulator
        self._serve("get_joint_properties", srv.GetJointProperties, self._joint_properties)
        self._serve("get_link_state", srv.GetLinkState, self._link_state, "state")
        self._serve("get_model_properties", srv.GetModelProperties, self._model_properties)
        self._serve("get_model_state", srv.GetModelState, self._model_state)
        self._serve("get_physics_properties", srv.GetPhysicsProperties, self._physics_properties)
        self._serve("get_world_properties", srv.GetWorldProperties, self._world_properties)

    def _serve(self, name: str, kind: Any, answer: Callable[[Any], Fields], what: str = "properties") -> None:
        text, call = f"{kind.__name__}: got {what}", self._simulation.jobs.call
        serve(
            f"/gazebo/{name}",
            kind,
            lambda request: {"status_message": text, **call(lambda: answer(request))},
            "status_message",
        )

    # -- in the owner's thread --

    def model(self, name: str) -> State:
        """The state of a model or robot; FrameError if it does not exist. 'model::link' means its model here."""
        return state_of("model", name.partition("::")[0], models(self._simulator))

    def _link(self, name: str) -> State:
        """The state of a link or of the world; FrameError if there is no such link.

        The links of the world's models are not kept apart: each is where its model is, as on /gazebo/link_states.
        """
        model, separator, _ = name.partition("::")
        is_of_world = separator and model in self._simulator.world.models
        return self.model(model) if is_of_world else state_of("link", name, links(self._simulator))

    def _robot(self, name: str) -> int:
        """A robot's index; FrameError if there is none of that name."""
        names = robot_names(self._simulator)
        if name not in names:
            known = ", ".join([*self._simulator.world.models, *names])
            raise FrameError(f"model [{name}] does not exist; there are: {known}")
        return names.index(name)

    def _link_state(self, request: Any) -> Fields:
        pose, twist = relative(self._link(request.link_name), self._link(request.reference_frame))
        return {"link_state": LinkState(request.link_name, pose, twist, request.reference_frame or "world")}

    def _model_state(self, request: Any) -> Fields:
        reference = request.relative_entity_name
        pose, twist = relative(self.model(request.model_name), self.model(reference))
        header = Header(0, convert.to_time(self._simulator.stamp_ns), reference or "world")
        return {"header": header, "pose": pose, "twist": twist}

    def _model_properties(self, request: Any) -> Fields:
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
        }

    def _joint_properties(self, request: Any) -> Fields:
        robot, _, joint = request.joint_name.rpartition("::")
        if joint not in WHEEL_JOINTS:
            raise FrameError(f"joint [{request.joint_name}] does not exist; there are: {', '.join(WHEEL_JOINTS)}")
        state = self._simulator.fleet.state(self._robot(robot) if robot else 0)
        side = WHEEL_JOINTS.index(joint)
        return {
            "type": srv.GetJointPropertiesResponse.REVOLUTE,  # as gazebo_ros says of every joint
            "damping": [0.0],
            "position": [state.wheel_angles[side]],
            "rate": [state.wheel_speeds[side]],
        }

    def _physics_properties(self, _request: Any) -> Fields:
        rate, time = self._simulator.rate, self._simulation.time_control
        return {
            "time_step": 1.0 / rate,
            "pause": time.paused,
            "max_update_rate": rate * time.pacer.factor,  # in Gazebo, too, 0 is as fast as possible
            "gravity": Vector3(0.0, 0.0, -STANDARD_GRAVITY),
        }

    def _world_properties(self, _request: Any) -> Fields:
        names = [name for name, _, _ in models(self._simulator)]
        return {"sim_time": self._simulator.time, "model_names": names}


def _each(names: List[str]) -> List[str]:
    """Names in their order, each once."""
    return list(dict.fromkeys(names))
