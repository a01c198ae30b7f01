"""The topics, with their rates and newest messages, as `rostopic list`, `hz` and `echo` show them."""

import time
from collections import deque
from typing import Any, Deque, Dict, List, Optional

import genpy
import roslib.message
import rospy

from ...names import absolute
from ...web import text
from ...web.state import PageState
from .part import Context, Inbox, Part

PERIOD = 0.5  # [s, wall] between two updates
SPAN = 5.0  # [s, wall] over which a rate is measured
MOST = 1000  # messages of this time: 200 Hz
COSTLY = ("sensor_msgs/Image", "sensor_msgs/CompressedImage", "sensor_msgs/PointCloud2")  # only where it is chosen
DEFAULT = "cmd_vel"
LINES, WIDTH = 60, 120  # of a message in full: lines, characters of a line
BRIEF = 100  # characters of a message on one line


class _Listener:
    """The newest message of one topic, and when messages came."""

    def __init__(self, topic: str, kind: str) -> None:
        self._times: Deque[float] = deque(maxlen=MOST)  # [s, wall]
        self.newest: Any = None
        self._subscriber = rospy.Subscriber(topic, class_of(kind), self._on_message, queue_size=1)

    def _on_message(self, message: Any) -> None:
        self.newest = message
        self._times.append(time.monotonic())

    def rate(self, factor: float) -> str:
        """Messages per simulated second, as `rostopic hz` shows them; empty while there are fewer than two.

        factor: simulated seconds per second
        """
        times = [at for at in list(self._times) if time.monotonic() - at <= SPAN]
        if len(times) < 2 or times[-1] <= times[0]:
            return ""
        return f"{(len(times) - 1) / (times[-1] - times[0]) / factor:.1f} Hz"

    def close(self) -> None:
        self._subscriber.unregister()


class Topics(Part):
    """One topic in full, and the list of all. While a browser is open it is subscribed to what is shown."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui = context.server.gui
        self._choice = gui.add_dropdown("Topic", (absolute("", DEFAULT),), hint="as rostopic hz and rostopic echo")
        self._echo = gui.add_html("")
        self._all = gui.add_checkbox("Listen to all", False, hint="except cameras; takes some processor time")
        self._list = gui.add_html("")
        self._listeners: Dict[str, _Listener] = {}
        self._shown_at = 0.0  # [s, wall]
        self._robot = ""

    def ask_master(self, state: PageState, inbox: Inbox) -> None:
        """Subscribe to what is chosen; here, since this is done also after the last browser has gone."""
        visited, chosen, every = bool(self.context.server.get_clients()), self._choice.value, self._all.value
        wanted = {
            topic: kind for topic, kind in state.topics if visited and (topic == chosen or every and kind not in COSTLY)
        }
        for topic in set(self._listeners) - set(wanted):
            self._listeners.pop(topic).close()
        for topic in set(wanted) - set(self._listeners):
            self._listeners[topic] = _Listener(topic, wanted[topic])

    def show(self, state: PageState) -> None:
        if time.monotonic() - self._shown_at < PERIOD:
            return
        self._shown_at = time.monotonic()
        self._offer(state)
        heard = {topic: listener for topic, listener in self._listeners.items() if listener.newest is not None}
        chosen, echo = heard.get(self._choice.value), "no message yet"
        if chosen is not None:
            echo = f"{chosen.rate(state.factor) or 'no message for some seconds'}\n{full(chosen.newest)}"
        self._echo.content = text.block(echo)
        known = {topic: (listener.rate(state.factor), brief(listener.newest)) for topic, listener in heard.items()}
        self._list.content = text.topics((topic, kind, *known.get(topic, ("", ""))) for topic, kind in state.topics)

    def _offer(self, state: PageState) -> None:
        names, default = tuple(topic for topic, _ in state.topics), absolute(state.selected, DEFAULT)
        chosen = default if state.selected != self._robot else self._choice.value
        self._robot = state.selected
        options = tuple(sorted({*names, default, chosen}))
        if self._choice.options != options:
            self._choice.options = options
        self._choice.value = chosen


def class_of(kind: str) -> Any:
    """The class of a type, such as geometry_msgs/Twist; one of unread bytes where the type's package is not built here.

    rospy has one class for all subscribers of a topic, so it has to be the one that other parts use.
    """
    return roslib.message.get_message_class(kind) or rospy.AnyMsg


def _lines(message: Any, fields: Optional[Any] = None) -> List[str]:
    if isinstance(message, rospy.AnyMsg):
        return ["a message of a type that is not built here"]
    return str(genpy.message.strify_message(message, field_filter=fields)).splitlines()


def full(message: Any) -> str:
    """As `rostopic echo` shows it, with long lines and long messages cut."""
    lines = _lines(message)
    return "\n".join([_cut(line, WIDTH) for line in lines[:LINES]] + ["…"] * (len(lines) > LINES))


def brief(message: Any) -> str:
    """On one line, without its header."""
    lines = _lines(message, lambda part: [name for name in part.__slots__ if name != "header"])
    return _cut(" ".join(" ".join(lines).split()), BRIEF)


def _cut(line: str, width: int) -> str:
    return line if len(line) <= width else line[: width - 1] + "…"
