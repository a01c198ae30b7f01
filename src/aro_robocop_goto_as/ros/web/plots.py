"""Plots of the errors and the commanded velocities of the last seconds."""

import time
from collections import deque
from dataclasses import dataclass
from typing import Any, Callable, Deque, Dict, Iterable, Tuple

import numpy as np
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import GoToPositionActionFeedback

from ...names import ACTION, absolute
from ...web.state import PageState
from .part import Context, Inbox, Part

Sample = Tuple[float, float, float]  # time [s] and two figures
Figures = Callable[[Any], Tuple[float, float]]  # a message -> its two figures

SPAN = 30.0  # [s, wall] that a plot of a running system shows
MAX_SAMPLES = 900  # samples: 30 Hz
HEIGHT = 150  # [pixel]
PERIOD = 0.25  # [s, wall] between two updates
COLORS = "#1c7ed6", "#e8590c"
TIME: Dict[str, Any] = {
    "label": "time [s], 0 is now",
    "labelFont": "12px sans-serif",
    "labelSize": 18,
    "size": 32,
    "grid": {"show": False},
}
AROUND_ZERO = {"min": {"pad": 0.1, "soft": -0.1, "mode": 1}, "max": {"pad": 0.1, "soft": 0.5, "mode": 1}}


@dataclass(frozen=True)
class Plotted:
    """A topic of a robot, and the figures of its messages that are plotted."""

    texts: Tuple[str, str, str]  # title, labels of the figures
    topic: str
    kind: Any
    figures: Figures


def _errors(message: GoToPositionActionFeedback) -> Tuple[float, float]:
    return message.feedback.position_error, message.feedback.angle_error


def _velocities(message: Twist) -> Tuple[float, float]:
    return message.linear.x, message.angular.z


PLOTTED = (
    Plotted(("errors", "position [m]", "angle [rad]"), f"{ACTION}/feedback", GoToPositionActionFeedback, _errors),
    Plotted(("cmd_vel", "v [m/s]", "w [rad/s]"), "cmd_vel", Twist, _velocities),
)


class Plot(Part):
    """The last seconds until now; sent only while there is something in them."""

    def __init__(self, context: Context, plotted: Plotted) -> None:
        super().__init__(context)
        self._plotted = plotted
        title, *labels = plotted.texts
        # Dots, not lines, which would join the end of a goal with the start of the next.
        dots = ({"show": True, "size": 2.5, "width": 1, "stroke": color, "fill": color} for color in COLORS)
        figures = ({"label": label, "width": 0, "points": style} for label, style in zip(labels, dots))
        self._handle = context.server.gui.add_uplot(
            columns((), 0.0),
            ({"label": "t [s]"}, *figures),
            title=title,
            scales={"x": {"time": False, "range": (-SPAN, 0.0)}, "y": {"range": AROUND_ZERO}},
            axes=(TIME, {"size": 42, "space": 16}),
            legend={"live": False, "markers": {"width": 2}},
            height=HEIGHT,
            padding=(10, 12, 0, 0),
        )
        self._samples: Deque[Sample] = deque(maxlen=MAX_SAMPLES)
        self._changed = False  # the robot
        self._shown_at = 0.0  # [s, wall]
        self._robot = ""

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        if robot != self._robot:
            self._robot, self._changed = robot, True
            self._samples.clear()
        inbox.subscribe(absolute(robot, self._plotted.topic), self._plotted.kind, self._on_message, None)

    def _on_message(self, at: float, message: Any) -> None:
        self._samples.append((at, *self._plotted.figures(message)))

    def show(self, state: PageState) -> None:
        now = time.monotonic()
        if (self._changed or self._samples) and now - self._shown_at >= PERIOD:
            self._shown_at, self._changed = now, False
            while self._samples and now - self._samples[0][0] > SPAN:
                self._samples.popleft()
            self._handle.data = columns(self._samples, now)


def columns(samples: Iterable[Sample], now: float) -> Tuple[np.ndarray, ...]:
    """Times before `now` [s], negative, and both figures; all (n,), and never empty."""
    table = np.array([*samples] or [(now, 0.0, 0.0)])
    table[:, 0] -= now
    return tuple(np.ascontiguousarray(column) for column in table.T)
