"""Gazebo's topics about its world, /gazebo/model_states and /gazebo/link_states; and its IMU's service imu_service.

The message types are those of gazebo_msgs. If that package is not built, they are made here from their definitions:
to subscribers, types of the same name and md5sum are the same.
"""

import math
from typing import Any, Iterator, List, Sequence, Tuple

import genpy.dynamic
import rospy
from geometry_msgs.msg import Pose, Twist, Vector3
from std_srvs.srv import Empty, EmptyResponse

from ...errors import FrameError
from ...geometry import STANDSTILL, Pose3D, compose3, inverse3, lifted, quaternion_from_rpy
from ...names import prefixed
from ...robot.fleet import RobotState
from ...robot.model import WHEEL_JOINTS, RobotModel
from ...simulation.simulator import Simulator
from ...suggestions import unknown
from .. import convert
from ..publishing.publisher import publisher

WORLD_FRAMES = ("", "world", "map")  # names of the frame that Gazebo's poses are in
SEPARATOR = "=" * 80
DEFINITION = "string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n"  # of both types

State = Tuple[str, Pose3D, Twist]  # name, pose and velocity in Gazebo's world


def message_type(name: str) -> Any:
    """The class of gazebo_msgs/ModelStates or LinkStates."""
    parts = [DEFINITION]
    for part in (Pose, Twist):
        parts.append(f"{SEPARATOR}\nMSG: {part._type}\n{part._full_text}")  # genpy has no public name for it
    kind = f"gazebo_msgs/{name}"
    return genpy.dynamic.generate_dynamic(kind, "\n".join(parts))[kind]


class GazeboTopics:
    """Published by the simulation thread at clock ticks, while somebody subscribes."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._topics = [
            (publisher(f"/gazebo/{topic}", kind), kind, states)
            for topic, kind, states in (
                ("model_states", message_type("ModelStates"), models),
                ("link_states", message_type("LinkStates"), links),
            )
        ]
        for robot in simulator.robots:  # the service does nothing, as that of Gazebo's plug-in
            rospy.Service(prefixed(robot.name, "imu_service"), Empty, lambda _: EmptyResponse())

    def publish(self) -> None:
        """All models and robots as they are now."""
        for topic, kind, states in self._topics:
            if topic.get_num_connections():
                topic.publish(to_message(kind, states(self._simulator)))


def to_message(kind: Any, states: List[State]) -> Any:
    """A message of one of the two types."""
    return kind(
        [name for name, _, _ in states],
        [convert.to_pose_msg(pose) for _, pose, _ in states],
        [twist for _, _, twist in states],
    )


def robot_names(simulator: Simulator) -> List[str]:
    """The robots' names in Gazebo: a single robot has its model's, as with Gazebo's spawn_model."""
    return [robot.name or robot.model.name for robot in simulator.robots]


def _robots(simulator: Simulator) -> Iterator[Tuple[str, RobotModel, RobotState]]:
    fleet = simulator.fleet
    return zip(robot_names(simulator), fleet.models, map(fleet.state, range(len(fleet))))


def _world_twist(state: RobotState) -> Twist:
    """A robot's twist in the world's axes, as Gazebo gives it."""
    v, yaw = state.twist.v, state.world_from_footprint.yaw
    return Twist(Vector3(v * math.cos(yaw), v * math.sin(yaw), 0.0), Vector3(0.0, 0.0, state.twist.w))


def raised(pose: Pose3D, height: float) -> Pose3D:
    """A pose higher by `height` [m]: Gazebo has the ground where the world's file has it, the simulator at z = 0."""
    x, y, z = pose.position
    return Pose3D((x, y, z + height), pose.orientation)


def state_of(name: str, states: Sequence[State]) -> State:
    """The state of a model or of the world; FrameError if there is none."""
    if name in WORLD_FRAMES:
        return name, Pose3D(), convert.to_twist_msg(STANDSTILL)
    known = {state[0]: state for state in states}
    if name not in known:
        raise FrameError(unknown(f"model [{name}] does not exist", name, known))
    return known[name]


def relative(moving: State, frame: State) -> Tuple[Pose, Twist]:
    """Pose and velocity of something relative to a frame, in the frame's axes, as in gazebo_ros."""
    (_, pose, twist), (_, origin, of_origin) = moving, frame
    vx, vy = twist.linear.x - of_origin.linear.x, twist.linear.y - of_origin.linear.y
    yaw, w = origin.on_plane().yaw, twist.angular.z - of_origin.angular.z
    c, s = math.cos(yaw), math.sin(yaw)
    turned = Twist(Vector3(c * vx + s * vy, c * vy - s * vx, 0.0), Vector3(0.0, 0.0, w))
    return convert.to_pose_msg(compose3(inverse3(origin), pose)), turned


def models(simulator: Simulator) -> List[State]:
    """The models in Gazebo's order: the world's, the robots, models spawned since; all but robots stand still here."""
    robots = [
        (name, raised(lifted(state.world_from_footprint), simulator.world.ground), _world_twist(state))
        for name, _, state in _robots(simulator)
    ]
    return _with_scenery(simulator, robots, "")


def links(simulator: Simulator) -> List[State]:
    """One link for each model of the world; of a robot its base and both wheels, as Gazebo merges fixed links."""
    found: List[State] = []
    for name, model, state in _robots(simulator):
        base, twist = raised(lifted(state.world_from_footprint), simulator.world.ground), _world_twist(state)
        found.append((f"{name}::base_footprint", base, twist))
        for joint, side, angle in zip(WHEEL_JOINTS, (0.5, -0.5), state.wheel_angles):
            position = (0.0, side * model.wheel_separation, model.wheel_radius)
            spun = Pose3D(position, quaternion_from_rpy(0.0, angle, 0.0))
            found.append((f"{name}::{joint[: -len('joint')]}link", compose3(base, spun), twist))
    return _with_scenery(simulator, found, "::link")


def _with_scenery(simulator: Simulator, robots: List[State], suffix: str) -> List[State]:
    """The states of robots, between the states of the world's models and of spawned models."""
    standing, world = convert.to_twist_msg(STANDSTILL), simulator.world
    first, last = (
        [
            (name + suffix, raised(pose, world.ground), standing)
            for name, pose in world.models.items()
            if (name in simulator.models_at_start) == is_first
        ]
        for is_first in (True, False)
    )
    return [*first, *robots, *last]
