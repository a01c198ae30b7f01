"""Draws a record as inline SVG plots, with matplotlib; they need no script, file or network."""

import io
import math
import re
from typing import Any, Callable, Dict, List, NamedTuple, Sequence, Tuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import MultipleLocator

from ..handout import GOAL_RADIUS, HEADING_TOLERANCE, STOP_DISTANCE
from ..record import TERMINAL, Record, Sample, SentGoal, status_name

BLUE, ORANGE, GREEN, RED, GREY = "#1f6fb4", "#d9730d", "#2c8a3d", "#c62828", "#777777"
STATE_COLOURS = {"ACTIVE": BLUE, "SUCCEEDED": GREEN, "ABORTED": RED, "PREEMPTED": ORANGE}
WIDTH = 6.4  # [inch]
TOP, BOTTOM, LEFT, RIGHT, BETWEEN = 0.3, 0.42, 0.55, 0.35, 0.42  # [inch] margins
LEFT_OF_NAMES = 1.7  # [inch]
STYLE = {
    "svg.fonttype": "none",  # keep text as text: smaller and searchable
    "svg.hashsalt": "robocop",  # reproducible ids
    "font.size": 8.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#999999",
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.borderaxespad": 0.2,
}
JUMP = 0.2  # [m] per tick: faster than any robot drives, so it was moved by hand
MAX_POINTS = 600  # of a curve
GAP = 0.5  # [s] without a value interrupts a curve
MAX_DISTANCE = 50.0  # [m] goals farther from odom's origin are not drawn
MAX_GOALS = 6  # in a timeline
NOT_INLINE = re.compile(r'<metadata>.*?</metadata>|\sxmlns(:\w+)?="[^"]*"|\sclass="[^"]*"', re.DOTALL)

Curve = Tuple[str, str, Sequence[Tuple[float, float]]]  # name, colour, points


class Drawing(NamedTuple):
    """The functions that draw a record into axes below each other, and the size of the axes."""

    draw: Callable[[Sequence[Axes], Record, Sequence[float]], None]
    height: float  # [inch]
    rows: int = 1
    left: float = LEFT  # [inch]


def svg(name: str, record: Record, at: Sequence[float]) -> str:
    """One of the PLOTS as an element of an HTML page, with these simulated times [s] marked."""
    draw, height, rows, left = PLOTS[name]
    text = io.StringIO()
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, height))
        axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
        # Fixed margins: a constrained layout takes as long as drawing.
        row = (height - TOP - BOTTOM - (rows - 1) * BETWEEN) / rows
        right, top, between = 1.0 - RIGHT / WIDTH, 1.0 - TOP / height, BETWEEN / row
        figure.subplots_adjust(left / WIDTH, BOTTOM / height, right, top, hspace=between)
        draw(list(axes), record, at)
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    drawn = text.getvalue()
    return NOT_INLINE.sub("", drawn[drawn.index("<svg") :])


def over_time(
    axes: Axes, title: str, curves: Sequence[Curve], levels: Sequence[float], bound: float, stepped: bool = False
) -> None:
    """Curves over simulated time [s], clipped to +-`bound`.

    `levels` are thresholds to compare with. A `stepped` curve keeps each value until the next one.
    """
    axes.set_title(title)
    for name, colour, points in curves:
        curve = np.array([point for point in points if all(map(math.isfinite, point))]).reshape(-1, 2)
        curve = curve[:: max(1, len(curve) // MAX_POINTS)].clip((-math.inf, -bound), (math.inf, bound))
        times, values = curve.T
        if not stepped:  # a NaN in each longer interval without a value interrupts the curve
            ends = np.flatnonzero(np.diff(times) > GAP)
            times, values = np.insert(times, ends + 1, times[ends]), np.insert(values, ends + 1, np.nan)
        axes.plot(times, values, color=colour, label=name, drawstyle="steps-post" if stepped else "default")
    for level in levels:
        axes.axhline(level, color=GREY, linewidth=0.8, linestyle=(0, (4, 3)))
        place = {"xycoords": ("axes fraction", "data"), "va": "center"}
        _label(axes, f"{level:g}".replace("-", "−"), (1.0, level), (3, 0), color=GREY, **place)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=len(curves))


def _label(axes: Axes, words: str, at: Tuple[float, float], offset: Tuple[float, float], **style: Any) -> None:
    axes.annotate(words, at, xytext=offset, textcoords="offset points", **style)


def _finish(all_axes: Sequence[Axes], at: Sequence[float]) -> None:
    """Mark simulated times [s], and label the common axis."""
    for axes in all_axes:
        for moment in at:
            axes.axvline(moment, color=RED, linestyle=":", linewidth=1.6)
    all_axes[-1].set_xlabel("simulated time [s]")


def _legs(samples: Sequence[Sample]) -> List[List[Sample]]:
    """The path, split where the robot was placed elsewhere in the world."""
    legs: List[List[Sample]] = [[]]
    for sample in samples:
        if legs[-1] and math.hypot(sample.world_x - legs[-1][-1].world_x, sample.world_y - legs[-1][-1].world_y) > JUMP:
            legs.append([])
        legs[-1].append(sample)
    return legs


def _near(x: float, y: float) -> bool:
    """Return whether a goal is close enough to be drawn."""
    return math.hypot(x, y) < MAX_DISTANCE


def _name(goal: SentGoal) -> str:
    """A goal's id, shortened and without control characters."""
    return "".join(character for character in goal.id[-24:] if character.isprintable())


def _track(all_axes: Sequence[Axes], record: Record, at: Sequence[float]) -> None:
    """The path in odom, seen from above."""
    axes = all_axes[0]
    axes.set_title("path in odom [m], seen from above")
    for outline in record.obstacles:
        axes.add_patch(Polygon(list(zip(outline[::2], outline[1::2])), facecolor="#bbbbbb", edgecolor="#888888"))
    for goal in record.goals:
        if _near(goal.x, goal.y):
            axes.add_patch(Circle((goal.x, goal.y), GOAL_RADIUS, fill=False, edgecolor=GREEN, linewidth=1.5))
            _label(axes, f"goal {_name(goal)}", (goal.x, goal.y), (8, 6), color=GREEN, parse_math=False)
    for number, leg in enumerate(_legs(record.samples)):
        colour, name = (BLUE, "robot") if number == 0 else (GREY, "placed elsewhere")
        axes.plot([sample.x for sample in leg], [sample.y for sample in leg], color=colour, label=name if leg else None)
        if leg:
            axes.plot(leg[0].x, leg[0].y, "o", color=colour, markersize=4)
    for moment in at:
        near = min(record.samples, key=lambda sample: abs(sample.time - moment), default=None)
        if near is not None:
            axes.plot(near.x, near.y, "o", markersize=10, fillstyle="none", color=RED, markeredgewidth=1.8)
    seen = (
        [(sample.x, sample.y) for sample in record.samples]
        + [(goal.x, goal.y) for goal in record.goals if _near(goal.x, goal.y)]
        + [(click.odom_x, click.odom_y) for click in record.clicks]
    )
    if seen:  # obstacles do not extend the view
        axes.set_xlim(min(x for x, _ in seen) - 0.6, max(x for x, _ in seen) + 0.6)
        axes.set_ylim(min(y for _, y in seen) - 0.6, max(y for _, y in seen) + 0.6)
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=2)
    axes.set_aspect("equal", adjustable="datalim")
    largest = max((abs(number) for point in seen for number in point), default=0.0)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(0.5 if largest < 2.0 else 1.0))


def _on_way(record: Record) -> List[Tuple[Sample, SentGoal]]:
    """Samples with the goal that was active."""
    pairs = []
    for goal, newer in zip(record.goals, [*record.goals[1:], None]):
        end = min(record.active_until(goal), newer.time if newer else math.inf)
        pairs += [(sample, goal) for sample in record.samples if goal.time <= sample.time <= end]
    return pairs


def _errors(all_axes: Sequence[Axes], record: Record, at: Sequence[float]) -> None:
    """Both errors: ground truth and feedback."""
    pairs = [(s.time, g.errors_at(s)) for s, g in _on_way(record)]
    told = [(message.time, (message.position_error, message.angle_error)) for message in record.feedback]
    for index, (title, levels) in enumerate(
        (("position error [m]", [GOAL_RADIUS]), ("angle error [rad]", [HEADING_TOLERANCE, -HEADING_TOLERANCE]))
    ):
        curves = [
            ("true", BLUE, [(time, errors[index]) for time, errors in pairs]),
            ("feedback", ORANGE, [(time, errors[index]) for time, errors in told]),
        ]
        over_time(all_axes[index], title, curves, levels, 50.0)
    _finish(all_axes, at)


def _distances(all_axes: Sequence[Axes], record: Record, at: Sequence[float]) -> None:
    """The distances to the goal and to the nearest obstacle ahead."""
    curves = [
        ("to the goal", BLUE, [(s.time, g.errors_at(s)[0]) for s, g in _on_way(record)]),
        ("to the nearest obstacle ahead", RED, [(s.time, s.ahead) for s in record.samples]),
    ]
    over_time(all_axes[0], "distance [m]", curves, [STOP_DISTANCE, GOAL_RADIUS], 4.0)
    _finish(all_axes, at)


def _speeds(all_axes: Sequence[Axes], record: Record, at: Sequence[float]) -> None:
    """The velocity commands."""
    curves = [
        ("linear.x [m/s]", BLUE, [(command.time, command.v) for command in record.commands]),
        ("angular.z [rad/s]", ORANGE, [(command.time, command.w) for command in record.commands]),
    ]
    over_time(all_axes[0], "commands", curves, [], 10.0, stepped=True)
    _finish(all_axes, at)


def _states(all_axes: Sequence[Axes], record: Record, at: Sequence[float]) -> None:
    """Each goal's states over time."""
    axes, goals = all_axes[0], record.goals[:MAX_GOALS]
    axes.set_title("states of the goals")
    end = record.samples[-1].time if record.samples else 1.0
    axes.set_xlim(record.samples[0].time if record.samples else 0.0, end)
    for row, goal in enumerate(goals):
        changes = sorted(
            [(goal.time, "sent")]
            + [(change.time, status_name(change.status)) for change in record.statuses if change.id == goal.id],
            key=lambda change: change[0],
        )
        for (start, name), (until, _) in zip(changes, [*changes[1:], (end, "")]):
            terminal = name in [status_name(status) for status in TERMINAL]
            axes.broken_barh(
                [(start, until - start)],
                (row - 0.35, 0.7),
                color=STATE_COLOURS.get(name, GREY),
                alpha=0.35 if terminal else 0.85,
                linewidth=0,
            )
            if name != "sent":
                colour = "black" if terminal else "white"
                _label(axes, name, (start, row), (3, 0), va="center", fontsize=7.5, color=colour, annotation_clip=False)
    axes.set_yticks(range(len(goals)), [_name(goal) for goal in goals], parse_math=False)
    axes.set_ylim(max(1, len(goals)) - 0.5, -0.5)
    axes.grid(False, axis="y")
    _finish(all_axes, at)


PLOTS: Dict[str, Drawing] = {
    "track": Drawing(_track, 3.6),
    "errors": Drawing(_errors, 3.4, 2),
    "distances": Drawing(_distances, 2.2),
    "speeds": Drawing(_speeds, 2.0),
    "states": Drawing(_states, 1.5, left=LEFT_OF_NAMES),
}
