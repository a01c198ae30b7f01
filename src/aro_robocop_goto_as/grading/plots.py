"""A record -> plots as inline SVG: no script, no file, no network."""

import math
from html import escape
from typing import Callable, Dict, List, Sequence, Tuple

from .plan import Limits
from .record import STATUS_NAMES, TERMINAL, Goal, Record, Sample, end_of, errors_at

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 560.0, 180.0, 46.0, 26.0, 14.0
TRACK = 360.0  # height of the trajectory's plot
BLUE, ORANGE, GREEN, RED, GREY = "#1f6fb4", "#d9730d", "#2c8a3d", "#c62828", "#777"
JUMP = 0.2  # [m] in a tick: no robot drives so fast
MOST_POINTS = 600  # of a curve: more are not seen

Point = Tuple[float, float]
Curve = Tuple[str, str, Sequence[Point]]  # name, colour, points


def _number(value: float) -> str:
    return f"{value:.1f}".rstrip("0").rstrip(".")


def _thinned(points: Sequence[Point]) -> List[Point]:
    finite = [point for point in points if math.isfinite(point[0]) and math.isfinite(point[1])]
    step = max(1, len(finite) // MOST_POINTS)
    return finite[::step]


def _frame(title: str, body: str, height: float = HEIGHT) -> str:
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {height:g}" role="img" aria-label="{escape(title)}">'
        f'<text x="{LEFT:g}" y="10" class="title">{escape(title)}</text>{body}</svg>'
    )


def over_time(
    title: str,
    curves: Sequence[Curve],
    levels: Sequence[Tuple[float, str]] = (),
    at: Sequence[float] = (),
    bound: float = math.inf,
) -> str:
    """Curves over simulated time [s]; `levels` are limits to compare with, `at` moments to look at."""
    drawn = [
        (name, colour, _thinned([(t, max(-bound, min(bound, y))) for t, y in points]))
        for name, colour, points in curves
    ]
    everything = [point for _, _, points in drawn for point in points]
    if not everything:
        return _frame(title, f'<text x="{LEFT:g}" y="60">nothing was recorded</text>')
    t0, t1 = min(t for t, _ in everything), max(t for t, _ in everything)
    values = [y for _, y in everything] + [level for level, _ in levels]
    low, high = min(values), max(values)
    margin = 0.08 * (high - low) or 0.1
    low, high = low - margin, high + margin
    right, base = WIDTH - 8.0, HEIGHT - BOTTOM

    def place(t: float, y: float) -> Point:
        return LEFT + (t - t0) / ((t1 - t0) or 1.0) * (right - LEFT), base - (y - low) / (high - low) * (base - TOP)

    parts = [f'<rect x="{LEFT:g}" y="{TOP:g}" width="{right - LEFT:g}" height="{base - TOP:g}" class="box"/>']
    for share in (0.0, 0.5, 1.0):
        t, y = t0 + share * (t1 - t0), low + share * (high - low)
        x, _ = place(t, low)
        _, v = place(t0, y)
        parts.append(
            f'<text x="{x:.1f}" y="{HEIGHT - 12:g}" class="tick" text-anchor="middle">{_number(t)} s</text>'
            f'<text x="{LEFT - 4:g}" y="{v + 3:.1f}" class="tick" text-anchor="end">{y:.2f}</text>'
        )
    for level, words in levels:
        _, y = place(t0, level)
        parts.append(
            f'<line x1="{LEFT:g}" x2="{right:g}" y1="{y:.1f}" y2="{y:.1f}" class="level"/>'
            f'<text x="{right - 2:g}" y="{y - 2:.1f}" class="tick" text-anchor="end">{escape(words)}</text>'
        )
    for moment in at:
        x, _ = place(min(max(moment, t0), t1), low)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP:g}" y2="{base:g}" class="at"/>')
    parts += [_polyline(colour, [place(t, y) for t, y in points]) for _, colour, points in drawn]
    parts.append(_legend([(name, colour) for name, colour, _ in drawn]))
    return _frame(title, "".join(parts))


def _polyline(colour: str, points: Sequence[Point]) -> str:
    return (
        '<polyline fill="none" stroke-width="1.5" stroke="'
        + colour
        + '" points="'
        + " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        + '"/>'
    )


def _legend(entries: Sequence[Tuple[str, str]]) -> str:
    return "".join(
        f'<text x="{LEFT + 150 * number:g}" y="{HEIGHT - 1:g}" class="tick" fill="{colour}">— {escape(name)}</text>'
        for number, (name, colour) in enumerate(entries)
    )


def _legs(samples: Sequence[Sample]) -> List[List[Sample]]:
    """The way in parts, parted where the robot was set down elsewhere in the world."""
    legs: List[List[Sample]] = [[]]
    for sample in samples:
        if legs[-1] and math.hypot(sample.world_x - legs[-1][-1].world_x, sample.world_y - legs[-1][-1].world_y) > JUMP:
            legs.append([])
        legs[-1].append(sample)
    return legs


def track(record: Record, limits: Limits, at: Sequence[float]) -> str:
    """The way over the world, seen from above, in odom."""
    way = [(sample.x, sample.y) for sample in record.samples]
    points = way + [(goal.x, goal.y) for goal in record.goals] + [(c.odom_x, c.odom_y) for c in record.clicks]
    if not points:
        return _frame("trajectory", '<text x="46" y="60">nothing was recorded</text>')
    x0, x1 = min(x for x, _ in points) - 0.6, max(x for x, _ in points) + 0.6
    y0, y1 = min(y for _, y in points) - 0.6, max(y for _, y in points) + 0.6
    scale = min((WIDTH - 20) / (x1 - x0), (TRACK - 30) / (y1 - y0))

    def place(x: float, y: float) -> Point:
        return 10 + (x - x0) * scale, TRACK - 10 - (y - y0) * scale

    parts = ["<g>"]
    for outline in record.obstacles:
        corners = [place(x, y) for x, y in zip(outline[::2], outline[1::2])]
        parts.append('<polygon class="wall" points="' + " ".join(f"{x:.1f},{y:.1f}" for x, y in corners) + '"/>')
    for goal in record.goals:
        x, y = place(goal.x, goal.y)
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{0.1 * scale:.1f}" class="goal"/>'
            f'<text x="{x + 6:.1f}" y="{y - 6:.1f}" class="tick">{escape(goal.id[-24:])}</text>'
        )
    for moment in at:
        near = min(record.samples, key=lambda sample: abs(sample.time - moment), default=None)
        if near is not None:
            x, y = place(near.x, near.y)
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" class="spot"/>')
    for number, leg in enumerate(_legs(record.samples)):
        colour = BLUE if number == 0 else GREY  # set down elsewhere, so beside other obstacles
        parts.append(_polyline(colour, [place(x, y) for x, y in _thinned([(s.x, s.y) for s in leg])]))
    x, y = place(*way[0]) if way else (0.0, 0.0)
    parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{BLUE}"/></g>')
    return _frame(
        "trajectory from the dot on; green: goals, grey: obstacles and the way from a new start", "".join(parts), TRACK
    )


def _on_way(record: Record) -> List[Tuple[Sample, Goal]]:
    """Samples with the goal that was being pursued."""
    found = []
    for number, goal in enumerate(record.goals):
        ends = end_of(record, goal)
        until = ends[0].time if ends else math.inf
        if number + 1 < len(record.goals):
            until = min(until, record.goals[number + 1].time)
        found += [(sample, goal) for sample in record.samples if goal.time <= sample.time <= until]
    return found


def errors(record: Record, limits: Limits, at: Sequence[float]) -> str:
    """Both errors, true and fed back."""
    pairs = [(s.time, errors_at(s, g)) for s, g in _on_way(record)]
    position = over_time(
        "position error [m]",
        [
            ("true", BLUE, [(t, error[0]) for t, error in pairs]),
            ("feedback", ORANGE, [(it.time, it.position_error) for it in record.feedback]),
        ],
        [(0.1, "reached")],
        at,
        50.0,
    )
    angle = over_time(
        "angle error [rad]",
        [
            ("true", BLUE, [(t, error[1]) for t, error in pairs]),
            ("feedback", ORANGE, [(it.time, it.angle_error) for it in record.feedback]),
        ],
        [(0.1, "0.1"), (-0.1, "-0.1")],
        at,
        50.0,
    )
    return position + angle


def distances(record: Record, limits: Limits, at: Sequence[float]) -> str:
    """To the goal and to what is ahead."""
    return over_time(
        "distance to the goal and to the nearest obstacle ahead [m]",
        [
            ("goal", BLUE, [(s.time, errors_at(s, g)[0]) for s, g in _on_way(record)]),
            ("ahead", RED, [(s.time, s.ahead) for s in record.samples]),
        ],
        [(0.3, "0.3"), (0.1, "0.1")],
        at,
        4.0,
    )


def speeds(record: Record, limits: Limits, at: Sequence[float]) -> str:
    """What was commanded."""
    return over_time(
        "commanded linear.x [m/s] and angular.z [rad/s]",
        [
            ("linear.x", BLUE, [(it.time, it.v) for it in record.commands]),
            ("angular.z", ORANGE, [(it.time, it.w) for it in record.commands]),
        ],
        [(0.0, "")],
        at,
        10.0,
    )


def states(record: Record, limits: Limits, at: Sequence[float]) -> str:
    """Each goal's states over time."""
    if not record.samples:
        return _frame("states of the goals", '<text x="46" y="60">nothing was recorded</text>')
    t0, t1 = record.samples[0].time, record.samples[-1].time
    parts, right = [], WIDTH - 8.0
    for row, goal in enumerate(record.goals[:6]):
        y = TOP + 8 + row * 26
        changes = sorted(
            [(goal.time, "sent")] + [(s.time, STATUS_NAMES[s.status]) for s in record.statuses if s.id == goal.id],
            key=lambda change: change[0],
        )
        for number, (start, name) in enumerate(changes):
            end = changes[number + 1][0] if number + 1 < len(changes) else t1
            x, x2 = (LEFT + (t - t0) / ((t1 - t0) or 1.0) * (right - LEFT) for t in (start, end))
            colour = {"ACTIVE": BLUE, "SUCCEEDED": GREEN, "ABORTED": RED, "PREEMPTED": ORANGE}.get(name, GREY)
            shade = 0.35 if name in [STATUS_NAMES[it] for it in TERMINAL] else 0.8
            parts.append(
                f'<rect x="{x:.1f}" y="{y:g}" width="{max(1.0, x2 - x):.1f}" height="16" fill="{colour}" '
                f'opacity="{shade}"/>'
            )
            if x2 - x > 50 or number + 1 == len(changes):
                parts.append(f'<text x="{x + 3:.1f}" y="{y + 12:g}" class="tick">{name}</text>')
    for moment in at:
        x = LEFT + (min(max(moment, t0), t1) - t0) / ((t1 - t0) or 1.0) * (right - LEFT)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP:g}" y2="{HEIGHT - BOTTOM:g}" class="at"/>')
    return _frame(f"states of the goals, {_number(t0)} to {_number(t1)} s", "".join(parts))


PLOTS: Dict[str, Callable[[Record, Limits, Sequence[float]], str]] = {
    "track": track,
    "errors": errors,
    "distances": distances,
    "speeds": speeds,
    "states": states,
    "clicks": track,
}
