"""Pause and recorded time, on a page that shows a recording; `rosbag play` publishes the recording."""

import contextlib
import threading

import rospy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

from ...web import text
from ...web.state import PageState
from .part import Context, Inbox, Part

PLAY, PAUSE = "Play", "Pause"
PAUSE_SERVICE = "/player/pause_playback"  # of rosbag's player, by its name in launch/replay.launch
SERVICE_TIMEOUT = 20.0  # [s, wall] for the player to offer it


class ReplayPart(Part):
    """Only a page that shows a recording has this part."""

    def __init__(self, context: Context, waits: bool) -> None:
        """`waits`: the recording is paused until the first browser shows the page."""
        super().__init__(context)
        gui = context.server.gui
        self._waits = waits
        self._time = gui.add_html("")
        gui.add_button_group("Recording", (PLAY, PAUSE)).on_click(lambda event: _pause(event.target.value == PAUSE))

    def subscribe(self, inbox: Inbox) -> None:
        """Subscribe to the recorded clock."""
        inbox.subscribe("/clock", Clock, self._on_clock)

    def _on_clock(self, _: float, message: Clock) -> None:
        self._time.content = text.table([("recorded time", f"{message.clock.to_sec():.0f} s")])

    def show(self, state: PageState) -> None:
        """Play when the first browser has opened the page."""
        if self._waits:
            self._waits = False
            _pause(False)


def _pause(paused: bool) -> None:
    """Pause the recording or go on, in a thread, because the player may still be starting."""

    def call() -> None:
        with contextlib.suppress(rospy.ROSException, rospy.ServiceException):  # it has ended
            rospy.wait_for_service(PAUSE_SERVICE, SERVICE_TIMEOUT)
            rospy.ServiceProxy(PAUSE_SERVICE, SetBool)(paused)

    threading.Thread(target=call, daemon=True).start()
