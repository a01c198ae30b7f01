"""The lab's control law, period after period: pose, clearance ahead and goal -> a velocity, or an outcome."""

import enum
import math
from dataclasses import dataclass
from typing import Optional, Tuple, Union

from ..geometry import STANDSTILL, Pose2D, Twist2D, wrap_angle
from .params import GotoParams


class Outcome(enum.Enum):
    """Every way a goal can end; the result's message begins with the value."""

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
    """A goal position [m] in the odometry's frame."""

    x: float
    y: float


@dataclass(frozen=True)
class Errors:
    """Distance to the goal [m]; angle from the robot's heading to the goal's direction [rad], within +-pi."""

    position: float
    angle: float


@dataclass(frozen=True)
class Rotate:
    """Turn in place at this velocity."""

    errors: Errors
    twist: Twist2D


@dataclass(frozen=True)
class MoveForward:
    """Move straight ahead at this velocity."""

    errors: Errors
    twist: Twist2D


@dataclass(frozen=True)
class EndGoal:
    """End the goal with this outcome."""

    errors: Errors
    outcome: Outcome
    twist: Twist2D = STANDSTILL


Decision = Union[Rotate, MoveForward, EndGoal]


def errors_to(goal: Goal, pose: Pose2D) -> Errors:
    """The handout's position and angle errors; at the goal itself the angle error is zero."""
    dx, dy = goal.x - pose.x, goal.y - pose.y
    distance = math.hypot(dx, dy)
    angle = wrap_angle(math.atan2(dy, dx) - pose.yaw) if distance > 0.0 else 0.0
    return Errors(distance, angle)


def decide(pose: Pose2D, clearance: float, goal: Goal, params: GotoParams) -> Decision:
    """The handout's rule; `clearance` [m] is the distance to the nearest obstacle ahead, +inf for none.

    The goal is reached within position_tolerance. Otherwise rotate in place while the angle error exceeds
    angle_tolerance, then move forward, unless an obstacle ahead is nearer than obstacle_distance.
    """
    errors = errors_to(goal, pose)
    if errors.position < params.position_tolerance:
        return EndGoal(errors, Outcome.REACHED)
    if abs(errors.angle) > params.angle_tolerance:
        gain = params.angular_gain
        speed = _clamp(gain * abs(errors.angle), params.min_angular_velocity, params.max_angular_velocity)
        return Rotate(errors, Twist2D(0.0, math.copysign(speed, errors.angle)))
    if clearance < params.obstacle_distance:
        return EndGoal(errors, Outcome.OBSTACLE)
    speed = _clamp(params.linear_gain * errors.position, params.min_linear_velocity, params.max_linear_velocity)
    return MoveForward(errors, Twist2D(speed, 0.0))


def _clamp(speed: float, low: float, high: float) -> float:
    return max(low, min(high, speed))


def approach(value: float, target: float, step: float) -> float:
    """The value moved towards the target by at most `step`."""
    change = target - value
    return target if abs(change) <= step else value + math.copysign(step, change)


def limit_acceleration(previous: Twist2D, decision: Decision, dt: float, params: GotoParams) -> Twist2D:
    """The velocity to command `dt` [s] after `previous`: acceleration-limited, either linear or angular.

    The other velocity becomes 0 at once, because the handout's robot turns in place. So after each turn the command
    starts again at 0, and for some periods is below min_linear_velocity or min_angular_velocity.
    """
    if isinstance(decision, EndGoal):
        return STANDSTILL
    if isinstance(decision, Rotate):
        return Twist2D(0.0, approach(previous.w, decision.twist.w, params.angular_acceleration * dt))
    return Twist2D(approach(previous.v, decision.twist.v, params.linear_acceleration * dt), 0.0)


@dataclass(frozen=True)
class LastProgress:
    """The errors when the robot last made progress, and that time [s]."""

    errors: Errors
    since: float


def track_progress(
    last: Optional[LastProgress], errors: Errors, now: float, distance: float, angle: float
) -> LastProgress:
    """The newest progress at a time [s]: nearer to the goal by a distance [m], or turned to it by an angle [rad]."""
    if last is None:
        return LastProgress(errors, now)
    nearer = errors.position < last.errors.position - distance
    turned = abs(errors.angle) < abs(last.errors.angle) - angle
    return LastProgress(errors, now) if nearer or turned else last


@dataclass(frozen=True)
class Pursuit:
    """What a goal's next control period needs to know of the periods before."""

    twist: Twist2D = STANDSTILL  # commanded in the newest period
    progress: Optional[LastProgress] = None

    def without_progress(self, now: float) -> float:
        """How long [s] the robot has made no progress at a time [s]."""
        return 0.0 if self.progress is None else now - self.progress.since


def step(
    before: Pursuit, pose: Pose2D, clearance: float, goal: Goal, now: float, params: GotoParams
) -> Tuple[Decision, Pursuit]:
    """One control period at a time [s]: the rule's decision, and the pursuit with the velocity to command."""
    decision = decide(pose, clearance, goal, params)
    progress = track_progress(before.progress, decision.errors, now, params.stuck_distance, params.stuck_angle)
    twist = limit_acceleration(before.twist, decision, 1.0 / params.control_rate, params)
    return decision, Pursuit(twist, progress)
