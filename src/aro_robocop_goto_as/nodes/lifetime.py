"""A node from its start to its end, which a signal may ask for at any moment."""

import contextlib
import signal
import sys
import threading
from typing import Any, Iterator

import rospy

from ..errors import RobocopError
from ..interruption import heeded


@contextlib.contextmanager
def node(name: str, **options: Any) -> Iterator[None]:
    """rospy.init_node for the block in which the node lives; an error of ours in it is logged, with exit status 1.

    rospy shuts down inside its signal handler. Where that interrupts a call to the master, it waits for the lock that
    the interrupted call holds, for ever; so here a thread shuts down, and the call comes to its end.
    """
    for number in heeded():
        signal.signal(number, _shut_down)
    try:
        rospy.init_node(name, disable_signals=True, **options)
        yield
    except RobocopError as error:
        rospy.logfatal("%s: %s", error.code, error)
        sys.exit(1)
    except rospy.ROSException as error:  # a start cut short, or a topic closed under a publish
        if not rospy.core.is_shutdown_requested():
            raise
        rospy.logdebug("%s", error)


def _shut_down(number: int, _: object) -> None:
    threading.Thread(target=rospy.signal_shutdown, args=(f"signal {number}",)).start()
