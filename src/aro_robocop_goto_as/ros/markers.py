"""Building blocks for RViz markers."""

import math
from typing import List, Sequence, Tuple

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from ..geometry import Vector3

TEXT_COLOR = ColorRGBA(1.0, 1.0, 1.0, 1.0)
TEXT_SIZE, TEXT_HEIGHT = 0.14, 0.9  # [m] of a capital letter; above the floor, so that it stands beside the robot
ROBOT_COLOR = ColorRGBA(0.35, 0.78, 0.98, 1.0)
GOAL_COLOR = ColorRGBA(0.9, 0.2, 0.7, 0.9)
REACHED, NOT_REACHED = ColorRGBA(0.2, 0.7, 0.3, 0.9), ColorRGBA(0.6, 0.6, 0.6, 0.9)
# Colours of the sector in which the server looks for obstacles, by the distance of the nearest one:
FREE, NEAR, BLOCKED = ColorRGBA(0.2, 0.8, 0.3, 0.45), ColorRGBA(1.0, 0.75, 0.1, 0.55), ColorRGBA(0.95, 0.2, 0.15, 0.7)
UNKNOWN = ColorRGBA(0.6, 0.6, 0.6, 0.3)
TRAIL_COLOR = ColorRGBA(0.35, 0.78, 0.98, 0.8)
LINE_WIDTH = 0.02  # [m]
RING_RADIUS, RING_WIDTH = 0.25, 0.03  # [m] around the largest of the robots, a waffle
GOAL = "goal_circle", "goal_pin"  # namespaces
SEGMENTS = 24  # of an arc; enough to look round


def marker(namespace: str, kind: int, frame: str, color: ColorRGBA, number: int = 0) -> Marker:
    """A marker at the origin of a frame, which it follows: stamp zero means the newest transform."""
    made = Marker(ns=namespace, id=number, type=kind, action=Marker.ADD, color=color, frame_locked=True)
    made.header.frame_id = frame
    made.header.stamp = rospy.Time(0)
    made.pose.orientation.w = 1.0
    return made


def arc(radius: float, start: float, end: float, height: float = 0.0) -> List[Point]:
    """Points along an arc [m] from angle start to end [rad], counter-clockwise from x."""
    angles = [start + (end - start) * i / SEGMENTS for i in range(SEGMENTS + 1)]
    return [Point(radius * math.cos(angle), radius * math.sin(angle), height) for angle in angles]


def circle(namespace: str, radius: float, x: float, y: float, frame: str, color: ColorRGBA) -> Marker:
    """A circle [m] on the floor."""
    made = marker(namespace, Marker.LINE_STRIP, frame, color)
    made.scale.x = LINE_WIDTH
    made.points = arc(radius, 0.0, 2.0 * math.pi, 0.01)
    made.pose.position.x, made.pose.position.y = x, y
    return made


def robot_ring(frame: str) -> Marker:
    """A ring on the floor around the robot with this base frame; in a view of a whole room a burger is small."""
    ring = circle("robot_ring", RING_RADIUS, 0.0, 0.0, frame, ROBOT_COLOR)
    ring.scale.x = RING_WIDTH
    return ring


def trail(points: Sequence[Vector3], frame: str) -> Marker:
    """The line [m] along which a robot has driven; without points, the line that was drawn before is removed."""
    made = marker("trail", Marker.LINE_STRIP, frame, TRAIL_COLOR)
    made.action = Marker.ADD if len(points) > 1 else Marker.DELETE
    made.scale.x = LINE_WIDTH
    made.points = [Point(*point) for point in points]
    return made


def goal_color(is_unfinished: bool, is_reached: bool) -> ColorRGBA:
    """Green when the goal was reached, grey when it ended otherwise."""
    return GOAL_COLOR if is_unfinished else REACHED if is_reached else NOT_REACHED


def goal(tolerance: float, x: float, y: float, frame: str, color: ColorRGBA = GOAL_COLOR) -> Tuple[Marker, Marker]:
    """A circle of radius `tolerance` [m] around the goal, and a pin at the goal."""
    pin = marker(GOAL[1], Marker.CYLINDER, frame, color)
    pin.scale.x = pin.scale.y = 0.02
    pin.scale.z = 0.4
    pin.pose.position.x, pin.pose.position.y, pin.pose.position.z = x, y, 0.2
    return circle(GOAL[0], tolerance, x, y, frame, color), pin


def text(namespace: str, content: str, frame: str, number: int = 0) -> Marker:
    """Text above the origin of a frame, facing the viewer. RViz centres its lines around its position."""
    made = marker(namespace, Marker.TEXT_VIEW_FACING, frame, TEXT_COLOR, number)
    made.text = content
    made.scale.z = TEXT_SIZE
    made.pose.position.z = TEXT_HEIGHT + TEXT_SIZE * content.count("\n")
    return made
