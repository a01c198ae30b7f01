"""The server's markers for RViz: the newest goal and its tolerance, the safety cone, the robot, its state and trail."""

from typing import Optional, Sequence

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ...geometry import NANOSECONDS, Vector3
from ...goto.params import GotoParams
from ...goto.rule import Outcome
from .. import markers
from ..trail import Trail
from .goal_execution import GoalExecution
from .inputs import Inputs
from .tuning import Tuning

IDLE = "idle"  # the state before the first goal, and after a reset
MARKER_PERIOD = 0.1  # [s]
NEAR_FACTOR = 2.0  # the safety cone turns yellow within this multiple of the obstacle distance


def cone_color(clearance: Optional[float], limit: float) -> ColorRGBA:
    """Red below the limit [m], yellow within twice the limit, green beyond it, grey without a scan."""
    if clearance is None:
        return markers.UNKNOWN
    if clearance < limit:
        return markers.BLOCKED
    return markers.NEAR if clearance < NEAR_FACTOR * limit else markers.FREE


def _safety_cone(p: GotoParams, clearance: Optional[float], frame: str) -> Marker:
    """The part of the floor in which an obstacle ends a goal."""
    color = cone_color(clearance, p.obstacle_distance)
    cone = markers.marker("safety_cone", Marker.TRIANGLE_LIST, frame, color)
    cone.scale.x = cone.scale.y = cone.scale.z = 1.0
    rim = markers.arc(p.obstacle_distance, -p.obstacle_half_angle, p.obstacle_half_angle)
    for start, end in zip(rim, rim[1:]):
        cone.points += [Point(), start, end]
    return cone


def server_markers(
    p: GotoParams, inputs: Inputs, newest: Optional[GoalExecution], state: str, trail: Sequence[Vector3]
) -> MarkerArray:
    """All of the server's markers; without a goal until the first one, and after a reset. The trail is in odom [m]."""
    made, scan, odom = [], inputs.scan, inputs.odom
    if scan is not None and scan.message.header.frame_id:
        made.append(_safety_cone(p, inputs.clearance(), scan.message.header.frame_id))
    if odom is not None:
        base, frame = odom.message.child_frame_id, odom.message.header.frame_id
        made.append(markers.robot_ring(base))
        made.append(markers.text("state", state, base))
        made.append(markers.trail(trail, frame))
        if newest is not None:
            color = markers.goal_color(newest.outcome is None, newest.outcome is Outcome.REACHED)
            x, y = newest.goal.x, newest.goal.y
            made += markers.goal(p.position_tolerance, x, y, frame, color)
        else:
            made += [Marker(ns=name, action=Marker.DELETE) for name in markers.GOAL]
    return MarkerArray(made)


class Display:
    """Publishes the markers; the server sets `newest` and `state`."""

    def __init__(self, tuning: Tuning, inputs: Inputs) -> None:
        self.newest: Optional[GoalExecution] = None
        self.state = IDLE
        self._tuning, self._inputs = tuning, inputs
        self._trail = Trail()
        self._topic = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        rospy.Timer(rospy.Duration(MARKER_PERIOD), self._publish, reset=True)

    def _publish(self, _event: rospy.timer.TimerEvent) -> None:
        odom = self._inputs.odom
        if odom is not None:
            position = odom.message.pose.pose.position
            is_placed = self._trail.add(odom.stamp_ns / NANOSECONDS, position.x, position.y)
            if is_placed and (self.newest is None or self.newest.outcome is not None):  # a running goal goes on
                self.newest, self.state = None, IDLE
        if self._topic.get_num_connections():
            robot = rospy.get_namespace().strip("/")
            state = f"{robot}: {self.state}" if robot else self.state  # its text may stand beside another robot
            made = server_markers(self._tuning.params, self._inputs, self.newest, state, self._trail.points)
            self._topic.publish(made)
