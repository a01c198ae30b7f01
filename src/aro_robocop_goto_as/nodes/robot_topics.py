"""The topics of one robot: commands in, observations out, each with the stamp of its step."""

from typing import Any, Callable, Dict, List, Optional, Set

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped, Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan, MagneticField
from std_msgs.msg import Bool

from aro_robocop_goto_as.msg import TickAnswer

from .. import simulator
from ..geometry import Pose2D, Twist2D
from ..params import SimParams
from ..robot import CAMERA_FRAME
from ..sensors.scan_profiles import LidarSpec
from ..simulator import Observations
from . import convert
from .camera_topics import CameraTopics
from .packed import PackedOdometry
from .publishing import publisher

OnCommand = Callable[[int, str, Twist2D], None]  # robot, sender, velocity
OnAnswer = Callable[[int, str, TickAnswer], None]
OnPlace = Callable[[int, PoseWithCovarianceStamped], None]

ODOM_COVARIANCE = {"gazebo": convert.diagonal(convert.ODOM_VARIANCES), "real": convert.diagonal((0.0,) * 6)}
NAMELESS = "unknown"  # to rospy, a publisher that has not told its name yet: its connection is still being made
TRUTH_COVARIANCE = convert.diagonal(convert.TRUTH_VARIANCES)


def sender(message: rospy.AnyMsg) -> str:
    """The name of the node that a received message came from."""
    return str(message._connection_header["callerid"])


class RobotTopics:
    """Publishers and subscribers in a robot's namespace; its own frames carry its name as REP-105 frames can."""

    def __init__(self, index: int, name: str, p: SimParams, spec: LidarSpec, has_camera: bool) -> None:
        self.index = index
        self.name = name
        self.p = p
        self.spec = spec
        self.scan = publisher(self.topic("scan"), LaserScan)
        self.odom = publisher(self.topic("odom"), Odometry)
        self.joints = publisher(self.topic("joint_states"), JointState)
        self.imu = publisher(self.topic("imu"), Imu)
        self.truth = publisher(self.topic("ground_truth_odom"), Odometry)
        self.sensors: Dict[str, Any] = {  # sensor -> its topic, or topics, that tell how many are connected
            simulator.SCAN: self.scan, simulator.ODOM: self.odom, simulator.JOINTS: self.joints,
            simulator.IMU: self.imu}
        if p.ground_truth:
            self.sensors[simulator.TRUTH] = self.truth
        if p.bumper_rate:
            self.sensors[simulator.BUMPER] = publisher(self.topic("bumper"), Bool)
        if p.battery_state_rate:
            self.sensors[simulator.BATTERY] = publisher(self.topic("battery_state"), BatteryState)
        if p.magnetic_field_rate:
            self.sensors[simulator.FIELD] = publisher(self.topic("magnetic_field"), MagneticField)
        self.odom_frame, self.base_frame = self.frame(p.odom_frame), self.frame(p.base_frame)
        self.scan_frame, self.imu_frame = self.frame(p.scan_frame), self.frame(p.imu_frame)
        self.camera: Optional[CameraTopics] = None
        if has_camera and p.camera_rate:
            self.camera = CameraTopics(self.topic(""), p.camera(), self.frame(CAMERA_FRAME))
            self.sensors[simulator.CAMERA] = self.camera
        self._odom_message = PackedOdometry(self.odom_frame, self.base_frame, ODOM_COVARIANCE[p.covariances])
        self._truth_message = PackedOdometry(p.world_frame, self.base_frame, TRUTH_COVARIANCE)
        self._inputs: List[rospy.Subscriber] = []
        self._answers: Optional[rospy.Subscriber] = None

    def topic(self, name: str) -> str:
        """A topic of this robot; relative, so that a node's own namespace and remappings hold."""
        return f"{self.name}/{name}" if self.name else name

    def frame(self, name: str) -> str:
        """A frame of this robot."""
        return f"{self.name}/{name}" if self.name else name

    def listen(self, on_command: OnCommand, on_answer: OnAnswer, on_place: OnPlace) -> None:
        """Hand over what comes in, from rospy's threads."""
        i = self.index
        self._inputs = [
            # Else the publisher's kernel may hold a command back for 40 ms: at ten times real time, for 0.4 s.
            rospy.Subscriber(self.topic("cmd_vel"), Twist,
                             lambda m: on_command(i, sender(m), convert.from_twist_msg(m)), tcp_nodelay=True),
            rospy.Subscriber(self.topic("initialpose"), PoseWithCovarianceStamped, lambda m: on_place(i, m)),
        ]
        if self.p.sync == "lockstep":
            self._answers = rospy.Subscriber(self.topic("tick_answer"), TickAnswer,
                                             lambda m: on_answer(i, sender(m), m), tcp_nodelay=True)
            self._inputs.append(self._answers)

    def connected(self) -> Set[str]:
        """Names of the nodes that are connected to this robot's inputs."""
        return {link.callerid_pub for subscriber in self._inputs for link in subscriber.impl.connections}

    def answering(self) -> Set[str]:
        """Names of the nodes that are connected to answer ticks."""
        if self._answers is None:
            return set()
        return {link.callerid_pub for link in self._answers.impl.connections if link.callerid_pub != NAMELESS}

    def wanted(self) -> Set[str]:
        """Sensors that somebody listens to."""
        return {name for name, topic in self.sensors.items() if topic.get_num_connections()}

    def publish(self, seen: Observations, stamp: rospy.Time, wanted: Set[str]) -> None:
        """Send what one step brought of this robot."""
        i = self.index
        if seen.ground_truth is not None and simulator.TRUTH in wanted:
            self.truth.publish(self._truth_message.update(
                seen.ground_truth[i].world_from_base, seen.ground_truth[i].twist, stamp))
        if i in seen.imus:
            self.imu.publish(convert.to_imu(seen.imus[i], stamp, self.imu_frame, self.p))
        if seen.joints is not None and simulator.JOINTS in wanted:
            self.joints.publish(convert.to_joint_state(
                seen.joints[i].wheel_angles, seen.joints[i].wheel_velocities, stamp))
        if seen.odometry is not None and simulator.ODOM in wanted:
            self.odom.publish(self._odom_message.update(
                seen.odometry[i].odom_from_base, seen.odometry[i].twist, stamp))
        if i in seen.bumpers:
            self.sensors[simulator.BUMPER].publish(seen.bumpers[i])
        if i in seen.fields:
            self.sensors[simulator.FIELD].publish(convert.to_magnetic_field(seen.fields[i], stamp, self.imu_frame))
        if seen.battery and simulator.BATTERY in wanted:
            self.sensors[simulator.BATTERY].publish(convert.to_battery(stamp, self.base_frame))
        if i in seen.images and self.camera is not None:
            self.camera.publish(seen.images[i], stamp)
        if i in seen.scans:
            ranges = seen.scans[i].tolist()
            spec = self.spec if len(ranges) == self.spec.samples else self.spec.with_samples(len(ranges))
            self.scan.publish(convert.to_scan(ranges, spec, stamp, self.scan_frame))

    def transforms(self, seen: Observations, map_from_odom: Pose2D, stamp: rospy.Time) -> List[TransformStamped]:
        """odom -> base, and map -> odom where ground truth corrects it."""
        if seen.odometry is None:
            return []
        found = []
        if self.p.odom_tf:
            found.append(convert.to_transform(self.odom_frame, self.base_frame,
                                              seen.odometry[self.index].odom_from_base, stamp))
        if self.p.localization == "truth":
            found.append(convert.to_transform(self.p.map_frame, self.odom_frame, map_from_odom, stamp))
        return found
