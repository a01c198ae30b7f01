"""A thread that goes on after exceptions."""

import threading
import time
import traceback
from typing import Callable

import rospy

RETRY_PERIOD = 0.1  # [s, wall] after a failure


def start_daemon(name: str, step: Callable[[], None]) -> None:
    """Call `step` in a thread of its own, again and again; an exception is logged unless it equals the last one."""

    def run() -> None:
        logged = ""
        while True:
            try:
                step()
            except Exception:  # the thread's outermost level: otherwise a part of the page would end silently
                failure = traceback.format_exc()
                if failure != logged and not rospy.is_shutdown():
                    rospy.logerr("%s failed and continues:\n%s", name, failure)
                logged = failure
                time.sleep(RETRY_PERIOD)

    threading.Thread(target=run, daemon=True, name=name).start()
