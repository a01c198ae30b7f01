"""Server state -> RViz markers: the goal with its circle, the safety cone, the state as text above the robot."""

import math
import textwrap
from typing import List, Optional, Tuple

import rospy
from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ..goto import Goal
from ..params import GotoParams

FREE, NEAR, BLOCKED = ColorRGBA(0.2, 0.8, 0.3, 0.45), ColorRGBA(1.0, 0.75, 0.1, 0.55), ColorRGBA(0.95, 0.2, 0.15, 0.7)
UNKNOWN = ColorRGBA(0.6, 0.6, 0.6, 0.3)
GOAL_COLOR = ColorRGBA(0.9, 0.2, 0.7, 0.9)
TEXT_COLOR = ColorRGBA(1.0, 1.0, 1.0, 1.0)
SEGMENTS = 24  # of an arc, enough to look round
TEXT_HEIGHT = 0.6  # [m] above the floor
TEXT_WIDTH = 36  # characters of a line
NEAR_FACTOR = 2.0  # the cone turns yellow within this multiple of the obstacle distance


def following(namespace: str, kind: int, frame: str, color: ColorRGBA) -> Marker:
    """A marker that follows its frame: stamp zero means the newest transform."""
    marker = Marker(ns=namespace, id=0, type=kind, action=Marker.ADD, color=color, frame_locked=True)
    marker.header.frame_id = frame
    marker.header.stamp = rospy.Time(0)
    marker.pose.orientation.w = 1.0
    return marker


def _arc(radius: float, start: float, end: float, height: float) -> List[Point]:
    """Points along an arc [m] from angle start to end [rad], counter-clockwise from x."""
    angles = [start + (end - start) * i / SEGMENTS for i in range(SEGMENTS + 1)]
    return [Point(radius * math.cos(angle), radius * math.sin(angle), height) for angle in angles]


def cone_color(clearance: Optional[float], limit: float) -> ColorRGBA:
    """Green while the way is free, yellow within twice the limit [m], red below it, grey when nothing is known."""
    if clearance is None:
        return UNKNOWN
    if clearance < limit:
        return BLOCKED
    return NEAR if clearance < NEAR_FACTOR * limit else FREE


def _cone(p: GotoParams, clearance: Optional[float], frame: str) -> Marker:
    marker = following("safety_cone", Marker.TRIANGLE_LIST, frame, cone_color(clearance, p.obstacle_distance))
    marker.scale.x = marker.scale.y = marker.scale.z = 1.0
    rim = _arc(p.obstacle_distance, -p.obstacle_half_angle, p.obstacle_half_angle, 0.0)
    for near, far in zip(rim, rim[1:]):
        marker.points += [Point(), near, far]
    return marker


def circle_marker(namespace: str, radius: float, at: Goal, frame: str, color: ColorRGBA) -> Marker:
    """A circle [m] on the floor."""
    circle = following(namespace, Marker.LINE_STRIP, frame, color)
    circle.scale.x = 0.02
    circle.points = _arc(radius, 0.0, 2.0 * math.pi, 0.01)
    circle.pose.position.x, circle.pose.position.y = at.x, at.y
    return circle


def goal_markers(radius: float, goal: Goal, frame: str) -> Tuple[Marker, Marker]:
    """A pin where the goal is, and the circle [m] within which it is reached."""
    pin = following("goal_pin", Marker.CYLINDER, frame, GOAL_COLOR)
    pin.scale.x = pin.scale.y = 0.02
    pin.scale.z = 0.4
    pin.pose.position.z = 0.2
    pin.pose.position.x, pin.pose.position.y = goal.x, goal.y
    return circle_marker("goal_circle", radius, goal, frame, GOAL_COLOR), pin


def text_marker(namespace: str, text: str, frame: str) -> Marker:
    """Text above a robot's base frame, turned towards who looks."""
    marker = following(namespace, Marker.TEXT_VIEW_FACING, frame, TEXT_COLOR)
    marker.text = text
    marker.scale.z = 0.13
    marker.pose.position.z = TEXT_HEIGHT
    return marker


def removed(namespace: str) -> Marker:
    """Takes a marker away; nothing happens where there is none."""
    return Marker(ns=namespace, id=0, action=Marker.DELETE)


def server_markers(p: GotoParams, goal: Optional[Goal], clearance: Optional[float], scan_frame: str,
                   odom: Optional[Odometry], state: str) -> MarkerArray:
    """Everything the server shows; the goal's markers are taken away while there is none."""
    found = []
    if scan_frame:
        found.append(_cone(p, clearance, scan_frame))
    if odom is not None:
        found.append(text_marker("state", textwrap.fill(state, TEXT_WIDTH), odom.child_frame_id))
        if goal is None:
            found += [removed("goal_circle"), removed("goal_pin")]
        else:
            found += goal_markers(p.position_tolerance, goal, odom.header.frame_id)
    return MarkerArray(found)
