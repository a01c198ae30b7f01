"""What a page that shows a recording has besides: pause, the recorded time, and the checks that failed in it.

`rosbag play` publishes the recording, with its clock.
"""

import contextlib
import json
import shlex
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List

import rosbag
import rospy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from ...errors import ParameterError
from ...web import text
from ...web.state import PageState
from .part import Context, Inbox, Part

PLAY, PAUSE = "Play", "Pause"
PAUSE_SERVICE = "/player/pause_playback"  # of rosbag's player, by its name in launch/replay.launch
SERVICE_TIMEOUT = 20.0  # [s, wall] for the player to offer it
BEFORE = 1.0  # [s, recorded] before a failure, from where on it is shown


@dataclass(frozen=True)
class Failure:
    """A failed check: when [s, after the recording's beginning], and what was wrong."""

    check: str
    time: float
    text: str

    @property
    def start(self) -> str:
        """For `--start`: a little before the failure [s]."""
        return f"{max(self.time - BEFORE, 0.0):.1f}"


class Replay(Part):
    """Only a page that shows a recording has this part."""

    def __init__(self, context: Context, bag: str, waits: bool) -> None:
        """`waits`: the recording is paused until the first browser shows the page."""
        super().__init__(context)
        gui = context.server.gui
        self._waits = waits
        self._now = self._shown = ""
        self._time = gui.add_html("")
        gui.add_button_group("Recording", (PLAY, PAUSE)).on_click(lambda event: _pause(event.target.value == PAUSE))
        self._bag, self.failed = bag, failures(bag, beginning_of(bag))

    def add_failures(self) -> None:
        """List the failed checks in the part of the panel that is open now."""
        gui = self.context.server.gui
        for failure in self.failed:
            with gui.add_folder(f"✗ {failure.check}, failed at {failure.time:.1f} s"):
                command = f"./robocop replay {shlex.quote(self._bag)} --start {failure.start}"
                gui.add_html(text.answer(f"{failure.text} To see the moment: {command}"))

    def subscribe(self, inbox: Inbox) -> None:
        """Subscribe to the recorded clock."""
        inbox.subscribe("/clock", Clock, self._on_clock)

    def _on_clock(self, _at: float, message: Clock) -> None:
        self._now = f"{message.clock.to_sec():.0f} s"

    def show(self, state: PageState) -> None:
        if self._waits:
            self._waits = False
            _pause(False)
        if self._now != self._shown:
            self._shown = self._now
            self._time.content = text.table([("recorded time", self._now)])


def _pause(paused: bool) -> None:
    """Pause the recording or go on, in a thread, as the player may still be starting."""

    def call() -> None:
        with contextlib.suppress(rospy.ROSException, rospy.ServiceException):  # it has ended
            rospy.wait_for_service(PAUSE_SERVICE, SERVICE_TIMEOUT)
            rospy.ServiceProxy(PAUSE_SERVICE, SetBool)(paused)

    threading.Thread(target=call, daemon=True).start()


def beginning_of(bag: str) -> float:
    """Time of a bag's first message [s]; ParameterError for a file that is no bag or has none."""
    try:
        with rosbag.Bag(bag) as opened:
            return float(opened.get_start_time())
    except (OSError, rosbag.ROSBagException) as error:
        raise ParameterError(f"replay: {bag}: {error}") from error


def failures(bag: str, beginning: float) -> List[Failure]:
    """The failures of the scenario in PART-SCENARIO.bag, in order of time; none without a report beside it.

    beginning: of the recording [s]; a report's times are on the same clock, which continues through all scenarios
    """
    path = Path(bag)
    try:
        checks = json.loads((path.parent / "report.json").read_text(encoding="utf-8"))["checks"]
        failed = [check for check in checks if check["failure"] and f"{check['part']}-{check['scenario']}" == path.stem]
        found = [_failure(check, beginning) for check in failed]
    except (OSError, ValueError, KeyError, TypeError):  # no report, or another file of this name
        return []
    return sorted(found, key=lambda failure: failure.time)


def _failure(check: Any, beginning: float) -> Failure:
    failure = check["failure"]
    text = f"{_sentence(failure['cause'])} Expected {failure['expected']}, got {_sentence(failure['seen'])}"
    return Failure(str(check["name"]), float(failure["time"]) - beginning, text)


def _sentence(text: str) -> str:
    return text if text.endswith((".", "?", "!")) else f"{text}."
