"""Plots of the errors and the commanded velocities of the last seconds."""

import time
from collections import deque
from typing import Any, Callable, Deque, Dict, Iterable, List, Tuple

import numpy as np
from geometry_msgs.msg import Twist

from aro_robocop_goto_as.msg import GoToPositionActionFeedback

from ...names import ACTION, absolute
from ...web.state import PageState
from .part import Context, Inbox, Part

Sample = Tuple[float, float, float]  # time [s] and two figures
Texts = Tuple[str, str, str]  # title, labels of the figures
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


class PlotPart(Part):
    """The last seconds until now of a topic's figures; sent only while there is something in them."""

    def __init__(self, context: Context, texts: Texts, topic: str, kind: Any, figures: Figures) -> None:
        super().__init__(context)
        self._topic, self._kind, self._figures = topic, kind, figures
        title, *labels = texts
        # Dots, not lines, which would join the end of a goal with the start of the next.
        dots = ({"show": True, "size": 2.5, "width": 1, "stroke": color, "fill": color} for color in COLORS)
        series = ({"label": label, "width": 0, "points": style} for label, style in zip(labels, dots))
        self._handle = context.server.gui.add_uplot(
            columns((), 0.0),
            ({"label": "t [s]"}, *series),
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
        inbox.subscribe(absolute(robot, self._topic), self._kind, self._on_message, None)

    def _on_message(self, at: float, message: Any) -> None:
        self._samples.append((at, *self._figures(message)))

    def show(self, state: PageState) -> None:
        now = time.monotonic()
        if (self._changed or self._samples) and now - self._shown_at >= PERIOD:
            self._shown_at, self._changed = now, False
            while self._samples and now - self._samples[0][0] > SPAN:
                self._samples.popleft()
            self._handle.data = columns(self._samples, now)


def plots(context: Context) -> List[PlotPart]:
    """The two plots of a robot."""
    errors, velocities = ("errors", "position [m]", "angle [rad]"), ("cmd_vel", "v [m/s]", "w [rad/s]")
    return [
        PlotPart(
            context,
            errors,
            f"{ACTION}/feedback",
            GoToPositionActionFeedback,
            lambda message: (message.feedback.position_error, message.feedback.angle_error),
        ),
        PlotPart(context, velocities, "cmd_vel", Twist, lambda message: (message.linear.x, message.angular.z)),
    ]


def columns(samples: Iterable[Sample], now: float) -> Tuple[np.ndarray, ...]:
    """Times before `now` [s], negative, and both figures; all (n,), and never empty."""
    table = np.array([*samples] or [(now, 0.0, 0.0)])
    table[:, 0] -= now
    return tuple(np.ascontiguousarray(column) for column in table.T)
