"""The lab's loop: pose, clearance ahead and goal -> a velocity with feedback, or an outcome."""

import enum
import math
from dataclasses import dataclass
from typing import Optional, Sequence, Union

import numpy as np

from .drive import approach
from .geometry import STANDSTILL, Pose2D, Twist2D, wrap_angle
from .params import GotoParams


class Outcome(enum.Enum):
    """Every way a goal can end; the value starts the result's message."""

    REACHED = "REACHED"
    OBSTACLE = "OBSTACLE"
    PREEMPTED = "PREEMPTED"
    STUCK = "STUCK"
    TIMEOUT = "TIMEOUT"
    NO_ODOM = "NO_ODOM"
    NO_SCAN = "NO_SCAN"
    BAD_GOAL = "BAD_GOAL"
    SHUTDOWN = "SHUTDOWN"
    ERROR = "ERROR"


@dataclass(frozen=True)
class Goal:
    """Where to drive [m], in the frame of the odometry."""

    x: float
    y: float


@dataclass(frozen=True)
class Errors:
    """Distance to the goal [m] and from the robot's heading to the goal's direction [rad] within +-pi."""

    position: float
    angle: float


@dataclass(frozen=True)
class Rotate:
    """Turn in place at this velocity."""

    errors: Errors
    twist: Twist2D


@dataclass(frozen=True)
class Drive:
    """Drive straight ahead at this velocity."""

    errors: Errors
    twist: Twist2D


@dataclass(frozen=True)
class End:
    """The goal ends here."""

    errors: Errors
    outcome: Outcome
    twist: Twist2D = STANDSTILL


Decision = Union[Rotate, Drive, End]


def errors_to(goal: Goal, pose: Pose2D) -> Errors:
    """Both errors of the handout; on the goal itself the angle is zero."""
    dx, dy = goal.x - pose.x, goal.y - pose.y
    distance = math.hypot(dx, dy)
    angle = wrap_angle(math.atan2(dy, dx) - pose.yaw) if distance > 0.0 else 0.0
    return Errors(distance, angle)


def decide(pose: Pose2D, clearance: float, goal: Goal, params: GotoParams) -> Decision:
    """The handout's rule; `clearance` [m] is the distance to the nearest obstacle ahead, +inf for none.

    Reached within position_tolerance. Otherwise turn in place while the heading is off by more than angle_tolerance,
    else drive straight, unless an obstacle ahead is nearer than obstacle_distance.
    """
    errors = errors_to(goal, pose)
    if errors.position < params.position_tolerance:
        return End(errors, Outcome.REACHED)
    if abs(errors.angle) > params.angle_tolerance:
        speed = _proportional(params.angular_gain * abs(errors.angle), params.min_angular_velocity,
                              params.max_angular_velocity)
        return Rotate(errors, Twist2D(0.0, math.copysign(speed, errors.angle)))
    if clearance < params.obstacle_distance:
        return End(errors, Outcome.OBSTACLE)
    return Drive(errors, Twist2D(_proportional(params.linear_gain * errors.position, params.min_linear_velocity,
                                               params.max_linear_velocity), 0.0))


def _proportional(speed: float, low: float, high: float) -> float:
    return max(low, min(high, speed))


def smoothed(previous: Twist2D, decision: Decision, dt: float, params: GotoParams) -> Twist2D:
    """The velocity to command now, `dt` [s] after `previous`: acceleration-limited, never both turning and driving."""
    if isinstance(decision, End):
        return STANDSTILL
    if isinstance(decision, Rotate):
        return Twist2D(0.0, approach(previous.w, decision.twist.w, params.angular_acceleration * dt))
    return Twist2D(approach(previous.v, decision.twist.v, params.linear_acceleration * dt), 0.0)


@dataclass(frozen=True)
class Progress:
    """The errors when the robot last got somewhere, and when that was [s]."""

    errors: Errors
    since: float


def watch(progress: Optional[Progress], errors: Errors, now: float, params: GotoParams) -> Progress:
    """Progress is getting nearer by stuck_distance, or turning towards the goal by stuck_angle."""
    if progress is None:
        return Progress(errors, now)
    nearer = errors.position < progress.errors.position - params.stuck_distance
    turned = abs(errors.angle) < abs(progress.errors.angle) - params.stuck_angle
    return Progress(errors, now) if nearer or turned else progress


def clearance_ahead(ranges: Sequence[float], angle_min: float, increment: float, range_min: float, range_max: float,
                    half_angle: float) -> Optional[float]:
    """Nearest obstacle [m] within half_angle [rad] of straight ahead, in the scanner's frame; +inf for none.

    `ranges` (n_beams,) [m], counter-clockwise from angle_min for a positive increment [rad], any layout: 0 to 2 pi as
    Gazebo's, -pi to pi, or part of a turn. A return counts where range_min < range < range_max, the handout's rule;
    -inf is REP-117's "too near to measure" and counts as 0. Zero, NaN and +inf are no return.
    None where no beam points ahead, so nothing can be said.
    """
    distances = np.asarray(ranges, dtype=float)
    angles = angle_min + increment * np.arange(len(distances))
    ahead = np.abs(np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi) <= half_angle + 1e-9
    if not ahead.any():
        return None
    distances = distances[ahead]
    if np.isneginf(distances).any():
        return 0.0
    valid = distances[(distances > range_min) & (distances < range_max)]
    return float(valid.min()) if len(valid) else math.inf
