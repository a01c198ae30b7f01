"""Where the numbers of a serialized message begin, for messages with strings, lists and messages inside."""

import struct
from io import BytesIO

import pytest
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan, Range
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.ros.publishing.packed import places

TRANSFORM = Transform(Vector3(1.0, 2.0, 3.0), Quaternion(4.0, 5.0, 6.0, 7.0))
TWO = TFMessage([TransformStamped(), TransformStamped(Header(), "a", TRANSFORM)])
IMU = Imu(header=Header(frame_id="imu"), linear_acceleration=Vector3(1.0, 2.0, 3.0))
ODOMETRY = Odometry(header=Header(frame_id="odom"), child_frame_id="base")
ODOMETRY.twist.twist.angular.z = 5.0


@pytest.mark.parametrize(
    "message, part, numbers",
    [
        (JointState(Header(frame_id="ö"), ["left", "r"], [1.0, 2.0], [3.0, 4.0], []), "velocity", (3.0, 4.0)),
        (LaserScan(ranges=[1.5] * 3, intensities=[0.0, 2.5]), "intensities", (0.0, 2.5)),
        (Range(header=Header(frame_id="sonar_link"), max_range=4.0, range=0.5), "range", (0.5,)),
        (IMU, "linear_acceleration", (1.0, 2.0, 3.0)),
        (ODOMETRY, "twist.twist", (0.0, 0.0, 0.0, 0.0, 0.0, 5.0)),
        (TWO, "transforms[1].transform", range(1, 8)),
    ],
)
def test_numbers_of_a_part_begin_where_they_are_serialized(message, part, numbers):
    body = BytesIO()
    message.serialize(body)
    kind, start = places(message)[part]
    numeral = "f" if kind.startswith("float32") else "d"
    assert struct.unpack_from(f"<{len(numbers)}{numeral}", body.getvalue(), start) == tuple(numbers)
