"""One robot's topics: for each sensor its name, type and message.

A packed message holds its constant bytes, and the places for the numbers of each step. batch.c stamps and sends
packed messages; rospy sends the others.
"""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import genpy
import numpy as np
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Bool, Header
from tf2_msgs.msg import TFMessage

from ...geometry import Pose2D
from ...names import prefixed
from ...robot.model import CAMERA_FRAME
from ...sensors.bumper import BUMPER
from ...sensors.camera import CAMERA
from ...sensors.ground_truth import GROUND_TRUTH
from ...sensors.imu import FORCE, IMU, ORIENTATION, RATES, ImuParams
from ...sensors.lidar import SCAN
from ...sensors.odometry import JOINTS, ODOM
from ...sensors.scan_profiles import LidarSpec
from ...sim_params import TopicParams
from ...simulation.observations import Observations
from ...simulation.simulator import Simulator
from .. import convert
from ..publishing.packed import DOUBLES, FLOATS, HEADER, POSE, STAMP, TWIST, Field, PackedMessage, counter, string_size
from ..publishing.publisher import publisher

# Bytes. A message begins with its length, then come seq, stamp.secs and stamp.nsecs, then frame_id.
LENGTH, HEADER_SIZE = 4, 3 * 4
POSE_SIZE, COVARIANCE, COVARIANCE_3 = 7 * 8, 36 * 8, 9 * 8
SCAN_FIGURES = 7 * 4  # angle_min to range_max

# Variances of x, y, z, roll, pitch, yaw. A huge variance marks what a differential drive cannot measure. The figures
# are those of Gazebo's differential drive plugin, which existing lab code was written against.
ODOM_VARIANCES = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)
TRUTH_VARIANCES = (1e-12,) * 6
NO_VARIANCES = (0.0,) * 6  # as a real TurtleBot3 sends them
ORIENTATION_VARIANCE = 1e-6  # the simulated IMU's orientation is exact except for rounding
REAL_IMU_VARIANCES = (0.0025, 0.02, 0.04)  # orientation, rates, accelerations of a TurtleBot3's firmware

Row = np.ndarray  # of an array of the simulation, which changes in place


def packed_clock() -> PackedMessage:
    """A message on /clock."""
    return PackedMessage(Clock(), [Field(STAMP, LENGTH, None)])


def packed_scan(spec: LidarSpec, frame: str, ranges: Row, number: Optional[np.ndarray]) -> PackedMessage:
    """The ranges (n_beams,) [m] of one scanner; `number`: a counter, None: all have number 0.

    All beams of one scan are taken at once, as Gazebo does: time_increment and scan_time are zero.
    """
    template = LaserScan(
        header=Header(frame_id=frame),
        angle_min=spec.angle_min,
        angle_max=spec.angle_max,
        angle_increment=spec.increment,
        range_min=spec.range_min,
        range_max=spec.range_max,
        ranges=ranges.tolist(),
    )
    start = LENGTH + HEADER_SIZE + string_size(frame) + SCAN_FIGURES + LENGTH
    return PackedMessage(template, [Field(HEADER, LENGTH, number), Field(FLOATS, start, ranges)])


def packed_odometry(frame: str, child: str, variances: Tuple[float, ...], pose: Row, twist: Row) -> PackedMessage:
    """Pose (3,) of `child` in `frame` and twist (2,) in `child`, both with these variances (6,)."""
    template = Odometry(header=Header(frame_id=frame), child_frame_id=child)
    template.pose.covariance = template.twist.covariance = convert.diagonal(variances)
    start = LENGTH + HEADER_SIZE + string_size(frame) + string_size(child)
    fields = [Field(POSE, start, pose), Field(TWIST, start + POSE_SIZE + COVARIANCE, twist)]
    return PackedMessage(template, [Field(HEADER, LENGTH, counter()), *fields])


def packed_joint_state(angles: Row, speeds: Row) -> PackedMessage:
    """Wheel angles (2,) [rad] and speeds (2,) [rad/s], left and right."""
    template = convert.to_joint_state((0.0, 0.0), (0.0, 0.0), genpy.Time())
    start = LENGTH + HEADER_SIZE + string_size("") + LENGTH + sum(map(string_size, template.name)) + LENGTH
    fields = [Field(DOUBLES, start, angles), Field(DOUBLES, start + 2 * 8 + LENGTH, speeds)]
    return PackedMessage(template, [Field(HEADER, LENGTH, counter()), *fields])


def packed_imu(frame: str, noise: ImuParams, real: bool, sample: Row) -> PackedMessage:
    """A sample (10,) of sensors.imu; with the variances of its noise, or those that a real TurtleBot3 reports."""
    variances = (ORIENTATION_VARIANCE, noise.gyro_noise**2, noise.accelerometer_noise**2)
    orientation, rates, force = (convert.diagonal((it,) * 3) for it in (REAL_IMU_VARIANCES if real else variances))
    template = Imu(
        header=Header(frame_id=frame),
        orientation_covariance=orientation,
        angular_velocity_covariance=rates,
        linear_acceleration_covariance=force,
    )
    start = LENGTH + HEADER_SIZE + string_size(frame)
    fields = [Field(HEADER, LENGTH, counter())]
    for part in (ORIENTATION, RATES, FORCE):
        fields.append(Field(DOUBLES, start, sample[part]))
        start += sample[part].nbytes + COVARIANCE_3
    return PackedMessage(template, fields)


def packed_transforms(transforms: Sequence[Tuple[str, str, Row]]) -> PackedMessage:
    """One /tf message with transforms: parent, child, and parent_from_child (3,)."""
    template: List[TransformStamped] = []
    fields, start = [], 2 * LENGTH
    for parent, child, pose in transforms:
        template.append(convert.to_transform(parent, child, Pose2D(), genpy.Time()))
        fields.append(Field(HEADER, start, None))
        start += HEADER_SIZE + string_size(parent) + string_size(child)
        fields.append(Field(POSE, start, pose))
        start += POSE_SIZE
    return PackedMessage(TFMessage(template), fields)


class Topic(NamedTuple):
    """Where a sensor is published: with a packed message, or with one that rospy serializes each time."""

    name: str
    kind: Any
    packed: Optional[Callable[["SensorTopics"], PackedMessage]] = None
    message: Optional[Callable[["SensorTopics"], Any]] = None


def _odometry(robot: "SensorTopics") -> PackedMessage:
    rows, variances = robot.observed.odometry, NO_VARIANCES if robot.is_real else ODOM_VARIANCES
    poses, twists = rows.poses[robot.row], rows.twists[robot.row]
    return packed_odometry(robot.odom_frame, robot.footprint_frame, variances, poses, twists)


def _ground_truth(robot: "SensorTopics") -> PackedMessage:
    rows, frame = robot.observed.fleet, robot.frames.world_frame
    poses, twists = rows.poses[robot.row], rows.twists[robot.row]
    return packed_odometry(frame, robot.footprint_frame, TRUTH_VARIANCES, poses, twists)


def _joint_states(robot: "SensorTopics") -> PackedMessage:
    return packed_joint_state(robot.observed.joints.angles[robot.row], robot.observed.fleet.wheel_speeds[robot.row])


def _imu(robot: "SensorTopics") -> PackedMessage:
    frame, sensor = robot.frame(robot.frames.imu_frame), robot.observed.imu
    return packed_imu(frame, sensor.params, robot.is_real, sensor.samples[robot.row])


def _scan(robot: "SensorTopics") -> PackedMessage:
    ranges, spec = robot.observed.scan.ranges[robot.row], robot.observed.scan.lidar.spec
    spec = spec if len(ranges) == spec.samples else spec.with_samples(len(ranges))
    return packed_scan(spec, robot.frame(robot.frames.scan_frame), ranges, robot.scan_number)


# In the order in which they are sent on a step. A camera has several topics, see camera_topics.
TOPICS: Dict[str, Topic] = {
    BUMPER: Topic("bumper", Bool, message=lambda robot: robot.observed.bumper.touching[robot.row]),
    GROUND_TRUTH: Topic("ground_truth_odom", Odometry, _ground_truth),
    IMU: Topic("imu", Imu, _imu),
    JOINTS: Topic("joint_states", JointState, _joint_states),
    ODOM: Topic("odom", Odometry, _odometry),
    SCAN: Topic("scan", LaserScan, _scan),
}


class SensorTopics:
    """Publishers in a robot's namespace; its frames carry its name as a prefix."""

    def __init__(self, index: int, simulator: Simulator) -> None:
        p, self._name = simulator.params, simulator.robots[index].name
        self.row: int = index
        self.observed: Observations = simulator.observed
        self.frames = p.frames
        self.is_real = p.topics.covariances == "real"  # those that a TurtleBot3 sends
        self.odom_frame, self.footprint_frame = map(self.frame, (p.frames.odom_frame, p.frames.base_frame))
        self.scan_number = counter()  # whatever their number of beams
        self._packed: Dict[Tuple[str, int], PackedMessage] = {}  # by sensor and, for a scan, its number of beams
        self.topics: Dict[str, Any] = {  # by sensor
            sensor: publisher(self.frame(topic.name), topic.kind)
            for sensor, topic in TOPICS.items()
            if self.observed.by_name[sensor].rate
        }
        camera = self.observed.camera.specs[index]
        if camera is not None and self.observed.camera.rate:
            from .camera_topics import CameraTopics

            self.topics[CAMERA] = CameraTopics(self.frame(""), camera, self.frame(CAMERA_FRAME))

    def frame(self, name: str) -> str:
        """A frame or topic of this robot, with the robot's name as a prefix."""
        return prefixed(self._name, name)

    def packed(self, sensor: str) -> Optional[PackedMessage]:
        """The message of the newest measurement; None if publish() sends it."""
        pack, key = TOPICS[sensor].packed, (sensor, self.observed.scan.ranges.shape[1] if sensor == SCAN else 0)
        if pack is not None and key not in self._packed:
            self._packed[key] = pack(self)
        return self._packed.get(key)

    def publish(self, sensor: str) -> None:
        """Publish the newest measurement of a sensor whose message is not packed."""
        make = None if sensor == CAMERA else TOPICS[sensor].message
        if make is not None:
            self.topics[sensor].publish(make(self))
        elif self.row in self.observed.camera.images:
            stamp = convert.to_time(self.observed.stamp_ns)
            self.topics[sensor].publish(self.observed.camera.images[self.row], stamp)

    def transforms(self, topics: TopicParams) -> List[Tuple[str, str, Row]]:
        """Parent, child and parent_from_child (3,): odom -> base; map -> odom if it follows ground truth."""
        odometry, found = self.observed.odometry, []
        if topics.odom_tf:
            found.append((self.odom_frame, self.footprint_frame, odometry.poses[self.row]))
        if topics.localization == "truth":
            found.append((self.frames.map_frame, self.odom_frame, odometry.map_from_odom[self.row]))
        return found
