"""Server state -> RViz markers: the newest goal and its tolerance, the obstacle sector, the robot with its state."""

import textwrap
from typing import NamedTuple, Optional

from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ...goto import Goal, Outcome
from ...params import GotoParams
from .. import markers

FREE, NEAR, BLOCKED = ColorRGBA(0.2, 0.8, 0.3, 0.45), ColorRGBA(1.0, 0.75, 0.1, 0.55), ColorRGBA(0.95, 0.2, 0.15, 0.7)
UNKNOWN = ColorRGBA(0.6, 0.6, 0.6, 0.3)
REACHED, NOT_REACHED = ColorRGBA(0.2, 0.7, 0.3, 0.9), ColorRGBA(0.6, 0.6, 0.6, 0.9)
TEXT_WIDTH = 26  # characters per line
NEAR_FACTOR = 2.0  # the sector turns yellow within this multiple of the obstacle distance


class ShownGoal(NamedTuple):
    """The newest goal, which stays in RViz until the next one, and how it ended; None while it is executed."""

    goal: Goal
    outcome: Optional[Outcome] = None

    @property
    def color(self) -> ColorRGBA:
        """Green when it was reached, grey when it ended otherwise."""
        if self.outcome is None:
            return markers.GOAL_COLOR
        return REACHED if self.outcome is Outcome.REACHED else NOT_REACHED


def sector_color(clearance: Optional[float], limit: float) -> ColorRGBA:
    """Red below the limit [m], yellow within twice the limit, green beyond it, grey without a scan."""
    if clearance is None:
        return UNKNOWN
    if clearance < limit:
        return BLOCKED
    return NEAR if clearance < NEAR_FACTOR * limit else FREE


def _obstacle_sector(p: GotoParams, clearance: Optional[float], frame: str) -> Marker:
    """The part of the floor in which an obstacle ends a goal."""
    color = sector_color(clearance, p.obstacle_distance)
    sector = markers.marker("safety_cone", Marker.TRIANGLE_LIST, frame, color)
    sector.scale.x = sector.scale.y = sector.scale.z = 1.0
    rim = markers.arc(p.obstacle_distance, -p.obstacle_half_angle, p.obstacle_half_angle)
    for start, end in zip(rim, rim[1:]):
        sector.points += [Point(), start, end]
    return sector


def server_markers(
    p: GotoParams,
    shown: Optional[ShownGoal],
    clearance: Optional[float],
    scan_frame: str,
    odom: Optional[Odometry],
    state: str,
) -> MarkerArray:
    """All of the server's markers; without a goal until the first one."""
    made = []
    if scan_frame:
        made.append(_obstacle_sector(p, clearance, scan_frame))
    if odom is not None:
        made.append(markers.robot_ring(odom.child_frame_id))
        made.append(markers.text("state", textwrap.fill(state.partition(";")[0], TEXT_WIDTH), odom.child_frame_id))
        if shown is not None:
            x, y = shown.goal.x, shown.goal.y
            made += markers.goal(p.position_tolerance, x, y, odom.header.frame_id, shown.color)
    return MarkerArray(made)
