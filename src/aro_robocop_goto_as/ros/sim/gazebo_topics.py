"""What Gazebo publishes of its world: /gazebo/model_states, /gazebo/link_states; and its IMU's service imu_service.

The message types are gazebo_msgs', made here from their definitions where that package is not built: to subscribers,
types of the same name and md5sum are the same.
"""

import math
from typing import Any, Dict, List, Tuple

import genpy.dynamic
import rospy
from geometry_msgs.msg import Pose, Twist
from std_srvs.srv import Empty, EmptyRequest, EmptyResponse

from ...geometry import STANDSTILL, Pose3D, compose3, lifted, quaternion_from_rpy
from ...robot.model import WHEEL_JOINTS, RobotModel, RobotState
from ...simulation.simulator import Simulator
from .. import convert
from ..private_api import message_definition
from ..publishing import publisher
from .robot_topics import prefixed

SEPARATOR = "=" * 80
DEFINITION = "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n"  # of both types

State = Tuple[str, Pose3D, Any]  # name, pose in the world, geometry_msgs/Twist in the world


def message_type(name: str) -> Any:
    """The class of gazebo_msgs/ModelStates or LinkStates."""
    parts = [DEFINITION]
    for part in (Pose, Twist):
        name_of_part, definition = message_definition(part)
        parts.append(f"{SEPARATOR}\nMSG: {name_of_part}\n{definition}")
    kind = f"gazebo_msgs/{name}"
    return genpy.dynamic.generate_dynamic(kind, "\n".join(parts))[kind]


class GazeboTopics:
    """Published from the loop's thread at clock ticks, while somebody subscribes."""

    def __init__(self, robots: List[str]) -> None:
        """`robots`: their names; one without a name goes by its model's."""
        self._types: Dict[str, Any] = {name: message_type(name) for name in ("ModelStates", "LinkStates")}
        self._models = publisher("/gazebo/model_states", self._types["ModelStates"])
        self._links = publisher("/gazebo/link_states", self._types["LinkStates"])
        for robot in robots:
            rospy.Service(prefixed(robot, "imu_service"), Empty, _calibrate)

    def publish(self, simulator: Simulator) -> None:
        """All models and robots as they are now."""
        if self._models.get_num_connections():
            self._models.publish(to_message(self._types["ModelStates"], _models(simulator)))
        if self._links.get_num_connections():
            self._links.publish(to_message(self._types["LinkStates"], _links(simulator)))


def to_message(kind: Any, states: List[State]) -> Any:
    """A message of one of the two types."""
    return kind(
        [name for name, _, _ in states],
        [convert.to_pose_msg(pose) for _, pose, _ in states],
        [twist for _, _, twist in states],
    )


def _calibrate(_request: EmptyRequest) -> EmptyResponse:
    """Gazebo's plug-in answers this, too, without doing anything."""
    return EmptyResponse()


def _robots(simulator: Simulator) -> List[Tuple[str, RobotModel, RobotState]]:
    return [
        (robot.name or robot.model.name, robot.model, simulator.engine.state(index))
        for index, robot in enumerate(simulator.robots)
    ]


def _twist_of(state: RobotState) -> Any:
    """The robot's twist in the world's axes, as Gazebo gives it."""
    twist, yaw = convert.to_twist_msg(state.twist), state.world_from_footprint.yaw
    twist.linear.x, twist.linear.y = state.twist.v * math.cos(yaw), state.twist.v * math.sin(yaw)
    return twist


def _models(simulator: Simulator) -> List[State]:
    """Models of the world stand still, also those whose obstacles move."""
    standing = convert.to_twist_msg(STANDSTILL)
    return [
        *((name, pose, standing) for name, pose in simulator.world.models.items()),
        *((name, lifted(state.world_from_footprint), _twist_of(state)) for name, _, state in _robots(simulator)),
    ]


def _links(simulator: Simulator) -> List[State]:
    """One link for each model of the world; of a robot its base and both wheels, as Gazebo merges fixed links."""
    standing = convert.to_twist_msg(STANDSTILL)
    found = [(f"{name}::link", pose, standing) for name, pose in simulator.world.models.items()]
    for name, model, state in _robots(simulator):
        base = lifted(state.world_from_footprint)
        found.append((f"{name}::base_footprint", base, _twist_of(state)))
        for joint, side, angle in zip(WHEEL_JOINTS, (0.5, -0.5), state.wheel_angles):
            spun = Pose3D(
                (0.0, side * model.wheel_separation, model.wheel_radius), quaternion_from_rpy(0.0, angle, 0.0)
            )
            found.append((f"{name}::{joint[: -len('joint')]}link", compose3(base, spun), _twist_of(state)))
    return found
