"""What was recorded in one scenario: plain values, all times simulated [s], written as JSON and read back.

Frames: x, y, yaw are true poses in odom (which starts at the robot); world_* the same in the world, which is elsewhere.
"""

import dataclasses
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Iterable, List, Tuple, Type

from ..geometry import wrap_angle

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED, LOST = range(10)
STATUS_NAMES = ("PENDING", "ACTIVE", "PREEMPTED", "SUCCEEDED", "ABORTED", "REJECTED", "PREEMPTING", "RECALLING",
                "RECALLED", "LOST")  # actionlib_msgs/GoalStatus
MOST_TEXT = 2_000  # characters of anybody's words that are kept
TERMINAL = (PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED, LOST)


@dataclass(frozen=True)
class Sample:
    """The truth at one control tick: pose [m, rad], velocity [m/s, rad/s], nearest thing within +-30 degrees [m]."""

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
class Goal:
    """A goal that was sent, in odom [m], with the ending that it has to have."""

    id: str
    x: float
    y: float
    time: float
    ends: str


@dataclass(frozen=True)
class Cancel:
    """A cancel request; an empty id is for all goals."""

    time: float
    id: str


@dataclass(frozen=True)
class Status:
    """A goal's status has changed."""

    time: float
    id: str
    status: int


@dataclass(frozen=True)
class Result:
    """A result message, with the goal's status in it."""

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


@dataclass(frozen=True)
class Command:
    """A cmd_vel message: linear.x [m/s], angular.z [rad/s]."""

    time: float
    v: float
    w: float


@dataclass(frozen=True)
class Click:
    """A 2D Nav Goal in a frame [m], and the same place in odom."""

    time: float
    frame: str
    x: float
    y: float
    odom_x: float
    odom_y: float


@dataclass(frozen=True)
class Line:
    """A line of the node's output, or an error it logged."""

    time: float
    text: str


@dataclass(frozen=True)
class Death:
    """The node's process ended by itself, or, with a reason, was ended for what it took."""

    time: float
    status: int
    reason: str = ""


@dataclass(frozen=True)
class Record:
    """All of one scenario. In a bridge's record, goals are those that the bridge sent."""

    name: str
    part: str  # server or bridge
    up: bool = True  # the node connected to all it has to
    servers: Tuple[str, ...] = ()  # action servers there were, by name
    types: Tuple[str, ...] = ()  # and their types
    problem: str = ""  # why the scenario was ended before its time
    obstacles: Tuple[Tuple[float, ...], ...] = ()  # outlines in odom: x, y, x, y, ... [m]
    samples: Tuple[Sample, ...] = ()
    goals: Tuple[Goal, ...] = ()
    cancels: Tuple[Cancel, ...] = ()
    statuses: Tuple[Status, ...] = ()
    results: Tuple[Result, ...] = ()
    feedback: Tuple[Feedback, ...] = ()
    commands: Tuple[Command, ...] = ()
    clicks: Tuple[Click, ...] = ()
    lines: Tuple[Line, ...] = ()
    deaths: Tuple[Death, ...] = ()
    marks: Dict[str, float] = field(default_factory=dict)  # named moments of the scenario [s]


_PARTS: Dict[str, Type[Any]] = {
    "samples": Sample, "goals": Goal, "cancels": Cancel, "statuses": Status, "results": Result, "feedback": Feedback,
    "commands": Command, "clicks": Click, "lines": Line, "deaths": Death}


def status_name(status: int) -> str:
    """A status for a person, also one that there is none of."""
    return STATUS_NAMES[status] if 0 <= status < len(STATUS_NAMES) else f"status {status}"


def write(record: Record, path: Path) -> None:
    """As JSON; infinity and NaN as Python's json has them."""
    new = path.with_suffix(".new")  # there as a whole, or not
    new.write_text(json.dumps(dataclasses.asdict(record)))
    new.replace(path)


def read(path: Path) -> Record:
    """What `write` wrote."""
    raw = json.loads(path.read_text())
    for name, kind in _PARTS.items():
        raw[name] = tuple(kind(**entry) for entry in raw[name])
    raw["servers"], raw["types"] = tuple(raw["servers"]), tuple(raw["types"])
    raw["obstacles"] = tuple(tuple(outline) for outline in raw["obstacles"])
    return Record(**raw)


def end_of(record: Record, goal: Goal) -> List[Result]:
    """The results of a goal, in the order they came."""
    return [result for result in record.results if result.id == goal.id]


def samples_between(record: Record, start: float, end: float) -> List[Sample]:
    """Samples within [start, end], a hair's breadth more to be sure of both ends."""
    return [sample for sample in record.samples if start - 1e-6 <= sample.time <= end + 1e-6]


def wrapped(angle: float) -> float:
    """The same angle [rad] within +-pi; NaN and infinity as they are."""
    return wrap_angle(angle) if math.isfinite(angle) else angle


def errors_at(sample: Sample, goal: Goal) -> Tuple[float, float]:
    """The handout's position_error [m] and angle_error [rad], true at this sample."""
    dx, dy = goal.x - sample.x, goal.y - sample.y
    return math.hypot(dx, dy), wrapped(math.atan2(dy, dx) - sample.yaw)


def output(records: Iterable[Record]) -> List[str]:
    """All lines of some records."""
    return [line.text for record in records for line in record.lines]
