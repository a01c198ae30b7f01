"""The lab's control law: pose, clearance ahead and goal -> a velocity, or an outcome."""

import enum
import math
from dataclasses import dataclass
from typing import Optional, Sequence, Union

import numpy as np

from .geometry import STANDSTILL, Pose2D, Twist2D, wrap_angle
from .goto_params import GotoParams


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
class End:
    """End the goal with this outcome."""

    errors: Errors
    outcome: Outcome
    twist: Twist2D = STANDSTILL


Decision = Union[Rotate, MoveForward, End]


def errors_to(goal: Goal, pose: Pose2D) -> Errors:
    """The handout's position and angle errors; at the goal itself the angle error is zero."""
    dx, dy = goal.x - pose.x, goal.y - pose.y
    distance = math.hypot(dx, dy)
    angle = wrap_angle(math.atan2(dy, dx) - pose.yaw) if distance > 0.0 else 0.0
    return Errors(distance, angle)


@dataclass(frozen=True)
class Turning:
    """The direction of a goal's newest rotation (1.0: counter-clockwise), and how often it has been reversed.

    With late data or commands, as on a busy machine or over a slow network, a robot turns too far each time; at full
    speed it would turn to and fro for ever. At half the speed after each reversal it comes to an end.
    """

    direction: float = 0.0
    reversals: int = 0

    def limit(self, params: GotoParams) -> float:
        """The maximum angular velocity [rad/s] now; at least min_angular_velocity."""
        return max(params.min_angular_velocity, math.ldexp(params.max_angular_velocity, -self.reversals))

    def after(self, decision: Decision) -> "Turning":
        """The same after one more decision."""
        if not isinstance(decision, Rotate):
            return self
        direction = math.copysign(1.0, decision.twist.w)
        return Turning(direction, self.reversals + (direction * self.direction < 0.0))


def decide(pose: Pose2D, clearance: float, goal: Goal, params: GotoParams, turning: Turning = Turning()) -> Decision:
    """The handout's rule; `clearance` [m] is the distance to the nearest obstacle ahead, +inf for none.

    The goal is reached within position_tolerance. Otherwise rotate in place while the angle error exceeds
    angle_tolerance, then move forward, unless an obstacle ahead is nearer than obstacle_distance. `turning`: the
    goal's rotations so far.
    """
    errors = errors_to(goal, pose)
    if errors.position < params.position_tolerance:
        return End(errors, Outcome.REACHED)
    if abs(errors.angle) > params.angle_tolerance:
        gain = params.angular_gain
        speed = _clamp(gain * abs(errors.angle), params.min_angular_velocity, turning.limit(params))
        return Rotate(errors, Twist2D(0.0, math.copysign(speed, errors.angle)))
    if clearance < params.obstacle_distance:
        return End(errors, Outcome.OBSTACLE)
    speed = _clamp(params.linear_gain * errors.position, params.min_linear_velocity, params.max_linear_velocity)
    return MoveForward(errors, Twist2D(speed, 0.0))


def _clamp(speed: float, low: float, high: float) -> float:
    return max(low, min(high, speed))


def approach(value: float, target: float, step: float) -> float:
    """The value moved towards the target by at most `step`."""
    change = target - value
    return target if abs(change) <= step else value + math.copysign(step, change)


def limit_acceleration(previous: Twist2D, decision: Decision, dt: float, params: GotoParams) -> Twist2D:
    """The velocity to command `dt` [s] after `previous`: acceleration-limited, either linear or angular."""
    if isinstance(decision, End):
        return STANDSTILL
    if isinstance(decision, Rotate):
        return Twist2D(0.0, approach(previous.w, decision.twist.w, params.angular_acceleration * dt))
    return Twist2D(approach(previous.v, decision.twist.v, params.linear_acceleration * dt), 0.0)


@dataclass(frozen=True)
class Progress:
    """The errors when the robot last made progress, and the time of that [s]."""

    errors: Errors
    since: float


def track_progress(last: Optional[Progress], errors: Errors, now: float, distance: float, angle: float) -> Progress:
    """The newest progress at a time [s]: nearer to the goal by a distance [m], or turned to it by an angle [rad]."""
    if last is None:
        return Progress(errors, now)
    nearer = errors.position < last.errors.position - distance
    turned = abs(errors.angle) < abs(last.errors.angle) - angle
    return Progress(errors, now) if nearer or turned else last


def clearance_ahead(
    ranges: Sequence[float], angle_min: float, increment: float, range_min: float, range_max: float, half_angle: float
) -> Optional[float]:
    """Nearest obstacle [m] within half_angle [rad] of straight ahead, in the scanner's frame; +inf for none.

    `ranges` (n_beams,) [m], counter-clockwise from angle_min for a positive increment [rad], clockwise for a negative
    one; 0 to 2 pi as Gazebo's, -pi to pi, or part of a turn. A return counts where range_min < range < range_max, the
    handout's rule. -inf means "too near to measure" (REP-117) and counts as 0. Any other number and +inf mean that
    there is nothing to return the beam: the drivers of the LDS-01 and LDS-02 send 0 where REP-117 asks for +inf. So a
    scanner that sends only zeros can't be told from one in an open space.
    None when no beam points ahead, or it can't be said which ones do: angles are no numbers, several beams have one
    direction, or they go round more than one and a half times, as angles in degrees would. NaN when no beam ahead is
    valid: all are NaN (REP-117), or the range limits are, or they are not in order, so that no return could count.
    """
    distances = np.asarray(ranges, dtype=float)
    if len(distances) > 1 and not 0.0 < abs(increment) * (len(distances) - 1) <= 3.0 * math.pi:  # true for NaN
        return None
    with np.errstate(invalid="ignore", over="ignore"):  # angles that are not numbers do not point ahead
        angles = angle_min + increment * np.arange(len(distances))
        ahead = np.abs(np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi) <= half_angle + 1e-9
    if not ahead.any():
        return None
    distances = distances[ahead]
    if np.isnan(distances).all() or not range_min < range_max:  # true where a limit is NaN, too
        return math.nan
    if np.isneginf(distances).any():
        return 0.0
    valid = distances[(distances > range_min) & (distances < range_max)]
    return float(valid.min()) if len(valid) else math.inf
