"""The newest messages that nodes log, the newest first."""

from collections import deque
from typing import Deque, Tuple

import rospy
from rosgraph_msgs.msg import Log as LogMessage

from ...web import text
from ...web.state import PageState
from .part import Context, Inbox, Part

REMEMBERED = 12  # messages


class Log(Part):
    """Received also without a browser: what a node says at its start is there when the page is opened."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        with context.server.gui.add_folder("Log"):
            self._html = context.server.gui.add_html("")
        self._lines: Deque[Tuple[int, str, str]] = deque(maxlen=REMEMBERED)
        self._subscribed = False

    def ask_master(self, state: PageState, inbox: Inbox) -> None:
        if not self._subscribed:
            self._subscribed = True
            inbox.subscribe("/rosout", LogMessage, self._on_log, None)

    def _on_log(self, _: float, message: LogMessage) -> None:
        if message.name != rospy.get_name():
            self._lines.append((message.level, message.name.lstrip("/"), message.msg))

    def show(self, state: PageState) -> None:
        self._html.content = text.log(reversed(self._lines))
