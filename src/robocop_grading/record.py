"""The recording of one scenario; all times are simulated [s].

x, y and yaw are true poses in odom, whose origin is where the scenario starts; world_* are the same poses in world.
"""

import math
import signal
from dataclasses import dataclass, field
from typing import Dict, List, Tuple, Union

from aro_robocop_goto_as.geometry import Pose2D, wrap_angle

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED, LOST = range(10)
STATUS_NAMES = tuple(
    "PENDING ACTIVE PREEMPTED SUCCEEDED ABORTED REJECTED PREEMPTING RECALLING RECALLED LOST".split()
)  # actionlib_msgs/GoalStatus
MAX_TEXT = 2_000  # characters that are kept of a text from the submission
AT_END = 0.25  # [s] before a result, in which the robot was where its goal ended
TERMINAL = (PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED, LOST)


@dataclass(frozen=True)
class Sample:
    """Ground truth at a control tick: pose [m, rad], velocity [m/s, rad/s], distance [m] to the nearest thing ahead."""

    time: float
    x: float
    y: float
    yaw: float
    world_x: float
    world_y: float
    world_yaw: float
    v: float
    w: float
    ahead: float
    touching: bool


@dataclass(frozen=True)
class SentGoal:
    """A goal that was sent, in odom [m], with its expected terminal state."""

    id: str
    x: float
    y: float
    time: float
    ends: str

    def errors_at(self, pose: Union[Sample, Pose2D]) -> Tuple[float, float]:
        """From a pose in odom, the true position_error [m] and angle_error [rad], as the handout defines them."""
        dx, dy = self.x - pose.x, self.y - pose.y
        return math.hypot(dx, dy), wrapped(math.atan2(dy, dx) - pose.yaw)


@dataclass(frozen=True)
class Cancel:
    """A cancel request: for the goal of its id, for goals up to its stamp [s], or for all if both are missing."""

    time: float
    id: str
    stamp: float = 0.0


@dataclass(frozen=True)
class Status:
    """A change of a goal's status."""

    time: float
    id: str
    status: int


@dataclass(frozen=True)
class Result:
    """A result message."""

    time: float
    id: str
    status: int
    success: bool
    message: str


@dataclass(frozen=True)
class Feedback:
    """A feedback message [m, rad]."""

    time: float
    id: str
    position_error: float
    angle_error: float

    @property
    def errors(self) -> Tuple[float, float]:
        """Both, in the order of errors_at."""
        return self.position_error, self.angle_error


ERRORS = ("position_error", "angle_error")


@dataclass(frozen=True)
class Command:
    """A cmd_vel message: linear.x [m/s], angular.z [rad/s]."""

    time: float
    v: float
    w: float


@dataclass(frozen=True)
class Click:
    """A 2D Nav Goal [m] in its frame, and the same position in odom."""

    time: float
    frame: str
    x: float
    y: float
    odom_x: float
    odom_y: float


@dataclass(frozen=True)
class Line:
    """A line of the node's output or log."""

    time: float
    text: str


KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)  # of a process, and as a shell or bubblewrap passes it on
OUT_OF_TIME = (-signal.SIGXCPU, 128 + signal.SIGXCPU)


@dataclass(frozen=True)
class NodeEnd:
    """The end of the node's process; with a reason if the grader has ended it."""

    time: float
    status: int
    reason: str = ""

    @property
    def is_unexplained(self) -> bool:
        """Return whether the node killed itself, or the kernel killed it because memory ran out; not the grader."""
        return self.status in KILLED and not self.reason


@dataclass(frozen=True)
class Record:
    """Everything recorded in one scenario; in a bridge's record, goals are those sent by the bridge."""

    name: str
    part: str  # server or bridge
    up: bool = True  # the server made all the connections it has to make
    servers: Tuple[str, ...] = ()  # names of the action servers that were found
    types: Tuple[str, ...] = ()  # of these servers, in the same order
    unpublished: Tuple[str, ...] = ()  # topics that the node subscribes to and nobody publishes
    other_types: Tuple[Tuple[str, str, str], ...] = ()  # the node's topics with a wrong type: name, type, expected one
    programs: Tuple[str, ...] = ()  # of ROS, such as rostopic, that the node has started
    delays: Tuple[Tuple[str, float], ...] = ()  # topics, and how long [s] messages waited for the node since its start
    started: Pose2D = Pose2D()  # odom_from_footprint when the node was started
    problem: str = ""  # why the scenario was ended early
    obstacles: Tuple[Tuple[float, ...], ...] = ()  # outlines in odom: x, y, x, y, ... [m]
    samples: Tuple[Sample, ...] = ()
    goals: Tuple[SentGoal, ...] = ()
    cancels: Tuple[Cancel, ...] = ()
    statuses: Tuple[Status, ...] = ()
    results: Tuple[Result, ...] = ()
    feedback: Tuple[Feedback, ...] = ()
    commands: Tuple[Command, ...] = ()
    clicks: Tuple[Click, ...] = ()
    lines: Tuple[Line, ...] = ()
    node_ends: Tuple[NodeEnd, ...] = ()
    marks: Dict[str, float] = field(default_factory=dict)  # moments of the scenario [s]; flags are 0 or 1

    def results_of(self, goal: SentGoal) -> List[Result]:
        """The results of a goal in order of arrival; a correct server sends one."""
        return [result for result in self.results if result.id == goal.id]

    def feedback_of(self, goal: SentGoal) -> List[Feedback]:
        """The feedback about a goal in order of arrival."""
        return [message for message in self.feedback if message.id == goal.id]

    def active_until(self, goal: SentGoal) -> float:
        """When a goal got its first terminal state or result; infinity if it got none."""
        ends = [result.time for result in self.results_of(goal)]
        ends += [change.time for change in self.statuses if change.id == goal.id and change.status in TERMINAL]
        return min(ends, default=math.inf)

    def samples_between(self, start: float, end: float) -> List[Sample]:
        """Samples within [start, end]; both ends are included in spite of rounding."""
        return [sample for sample in self.samples if start - 1e-6 <= sample.time <= end + 1e-6]


def status_name(status: int) -> str:
    """The name of a status, also of an undefined one."""
    return STATUS_NAMES[status] if 0 <= status < len(STATUS_NAMES) else f"status {status}"


def wrapped(angle: float) -> float:
    """An angle [rad] wrapped to +-pi; NaN and infinity are returned unchanged."""
    return wrap_angle(angle) if math.isfinite(angle) else angle
