"""Plots of the errors and the commanded velocities: of the last seconds, or of a whole recording."""

import math
import time
from collections import deque
from functools import partial
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Sequence, Set, Tuple

import numpy as np
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import GoToPositionActionFeedback

from ...web.state import PageState
from ..names import ACTION, absolute
from .part import Context, Inbox, Part
from .player import Player
from .replay import Failure

SPAN = 30.0  # [s, wall] that a plot of a running system shows
MOST = 900  # samples: 30 Hz
HEIGHT = 110  # [pixel]
PERIOD = 0.25  # [s, wall] between two updates
COLORS = "#1c7ed6", "#e8590c"
AXES = ({"size": 40, "grid": {"show": False}}, {"size": 42})
AROUND_ZERO = {"min": {"pad": 0.1, "soft": -0.1, "mode": 1}, "max": {"pad": 0.1, "soft": 0.5, "mode": 1}}
ERRORS, COMMANDS = ("errors", "position [m]", "angle [rad]"), ("cmd_vel", "v [m/s]", "w [rad/s]")
SHARE = "share"  # scale from 0 to 1, of what marks a time
PLAYED: Dict[str, Any] = {"label": "played", "scale": SHARE, "stroke": "#868e96", "fill": "rgba(134,142,150,0.18)"}
FAILED: Dict[str, Any] = {"label": "check failed", "scale": SHARE, "stroke": "#e03131", "width": 2}
POINTS = 400  # of a recording's plot
Sample = Tuple[float, float, float]  # time [s] and two figures
Figures = Callable[[Any], Tuple[float, float]]


def add_plot(gui: Any, texts: Tuple[str, str, str], data: Sequence[Any], span: Tuple[float, float], *marks: Any) -> Any:
    """A plot with its title, two figures and marks; data: times [s], the figures, the marks; span: of the time axis."""
    title, *labels = texts
    figures = ({"label": label, "stroke": color, "width": 1.5} for label, color in zip(labels, COLORS))
    series = ({"label": "t [s]"}, *figures, *({"points": {"show": False}, **mark} for mark in marks))
    scales = {"x": {"time": False, "range": span}, "y": {"range": AROUND_ZERO}, SHARE: {"range": (0.0, 1.0)}}
    look = {"axes": AXES, "legend": {"live": False}, "height": HEIGHT, "padding": (10, 12, 0, 0)}
    return gui.add_uplot(tuple(data), series, title=title, scales=scales, **look)


class Plots(Part):
    """The last seconds; sent only while something is received."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, nothing = context.server.gui, columns((), 0.0)
        self._handles = [add_plot(gui, texts, nothing, (-SPAN, 0.0)) for texts in (ERRORS, COMMANDS)]
        self._samples: List[Deque[Sample]] = [deque(maxlen=MOST), deque(maxlen=MOST)]  # by plot
        self._changed: Set[int] = set()  # plots
        self._shown_at = 0.0  # [s, wall]
        self._robot = ""

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        if robot != self._robot:
            self._robot = robot
            self.forget()
        for number, (topic, kind, figures) in enumerate(plotted(robot)):
            inbox.subscribe(topic, kind, partial(self._on_message, number, figures), None)

    def _on_message(self, number: int, figures: Figures, at: float, message: Any) -> None:
        self._samples[number].append((at, *figures(message)))
        self._changed.add(number)

    def show(self, state: PageState) -> None:
        now = time.monotonic()
        if now - self._shown_at >= PERIOD:
            self._shown_at = now
            while self._changed:
                number = self._changed.pop()
                self._handles[number].data = columns(self._samples[number], now)

    def forget(self) -> None:
        for number, samples in enumerate(self._samples):
            samples.clear()
            self._changed.add(number)


class RecordedPlots(Part):
    """The whole recording, shaded up to the moment that is shown; the times at which checks failed are marked."""

    def __init__(self, context: Context, player: Player, failed: Sequence[Failure]) -> None:
        super().__init__(context)
        self._player = player
        self._times = np.linspace(0.0, player.duration, POINTS)
        marks: Tuple[Any, ...] = (PLAYED,)
        self._marked: Tuple[np.ndarray, ...] = ()
        if failed:
            marks += (FAILED,)
            self._marked = (self._spikes([failure.time for failure in failed]),)
        nothing, gui = np.zeros(POINTS), context.server.gui
        data, span = (self._times, nothing, nothing, nothing, *self._marked), (0.0, player.duration)
        self._handles = [add_plot(gui, texts, data, span, *marks) for texts in (ERRORS, COMMANDS)]
        self._figures: Optional[Sequence[Tuple[np.ndarray, ...]]] = None  # not read yet
        self._position = math.nan  # [s] that is shown

    def _spikes(self, times: Sequence[float]) -> np.ndarray:
        spikes = np.zeros(POINTS)
        spikes[np.clip(np.searchsorted(self._times, times), 0, POINTS - 1)] = 1.0
        return spikes

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        """Read the recording; the plots of the robot before are gone."""
        self._figures = [
            held(self._player.samples(topic, figures), self._times) for topic, _, figures in plotted(robot)
        ]
        self._position = math.nan

    def show(self, state: PageState) -> None:
        position = self._player.position
        if self._figures is None or abs(position - self._position) < self._player.duration / POINTS:
            return
        self._position = position
        played = np.where(self._times <= position, 1.0, 0.0)
        for handle, figures in zip(self._handles, self._figures):
            handle.data = (self._times, *figures, played, *self._marked)


def plotted(robot: str) -> Tuple[Tuple[str, Any, Figures], Tuple[str, Any, Figures]]:
    """Topic, type and figures of each plot."""
    return (
        (absolute(robot, f"{ACTION}/feedback"), GoToPositionActionFeedback, _errors),
        (absolute(robot, "cmd_vel"), Twist, lambda message: (message.linear.x, message.angular.z)),
    )


def _errors(message: GoToPositionActionFeedback) -> Tuple[float, float]:
    return message.feedback.position_error, message.feedback.angle_error


def columns(samples: Iterable[Sample], now: float) -> Tuple[np.ndarray, ...]:
    """Those of the last seconds: times before `now` [s], negative, and both figures; all (n,), and never empty."""
    recent = [sample for sample in samples if now - sample[0] <= SPAN]
    table = np.array(recent or [(now, 0.0, 0.0)])
    table[:, 0] -= now
    return tuple(np.ascontiguousarray(column) for column in table.T)


def held(samples: Iterable[Sample], times: np.ndarray) -> Tuple[np.ndarray, ...]:
    """Each figure at these times (n,) [s]: its newest value, 0 before the first one."""
    table = np.array([(-np.inf, 0.0, 0.0), *samples])
    newest = np.searchsorted(table[:, 0], times, side="right") - 1
    return tuple(np.ascontiguousarray(column) for column in table[newest, 1:].T)
