"""Visitors' requests as messages and service calls, made by one thread, so that no caller waits for a service."""

import queue
import traceback
from typing import Any, Callable, Dict, Tuple

import rospy

from ...names import SIMULATOR, absolute
from ...web.state import SharedState
from ..waiting import wait_until
from .daemon import start_daemon

SERVICE_TIMEOUT, CONNECT_TIMEOUT = 2.0, 2.0  # [s, wall] for a service to appear, for a subscriber to connect
MAX_WAITING = 8  # requests


class Requests:
    """Carries out one request after the other; the state says what the last one failed with.

    Requests are ignored where nobody may send them, and while there is no ROS master, which the page says.
    """

    def __init__(self, state: SharedState) -> None:
        self._state = state
        self._jobs: queue.Queue[Tuple[str, Callable[[], str]]] = queue.Queue(MAX_WAITING)
        self._waiting = ""
        self._publishers: Dict[str, rospy.Publisher] = {}
        start_daemon("requests", self._step)

    def publish(self, what: str, name: str, message: Any, otherwise: str = "") -> None:
        """Publish on a topic of the selected robot; a new publisher is given some time to be found by subscribers."""
        topic = absolute(self._state.now.selected, name)

        def publish() -> str:
            if topic not in self._publishers:
                self._publishers[topic] = rospy.Publisher(topic, type(message), queue_size=1)
            publisher = self._publishers[topic]
            connected = wait_until(lambda: publisher.get_num_connections() > 0, CONNECT_TIMEOUT)
            publisher.publish(message)
            return "" if connected else f"nobody subscribes to {topic}{otherwise}"

        self._post(what, publish)

    def call(self, what: str, service: str, kind: Any, *arguments: Any) -> None:
        """Call a service of the simulator."""

        def call() -> str:
            name = absolute(SIMULATOR, service)
            rospy.wait_for_service(name, SERVICE_TIMEOUT)
            answer = rospy.ServiceProxy(name, kind)(*arguments)
            return "" if getattr(answer, "success", True) else answer.message

        self._post(what, call)

    def _post(self, what: str, job: Callable[[], str]) -> None:
        if self._state.now.accepts_requests:
            try:
                self._jobs.put_nowait((what, job))
            except queue.Full:
                self._answer(what, f"ignored, because {self._waiting} is still waiting for its answer")

    def _answer(self, what: str, outcome: str) -> None:
        self._state.change(answer=f"{what}: {outcome}" if outcome else "")

    def _step(self) -> None:
        what, job = self._jobs.get()
        self._waiting = what
        try:
            self._answer(what, job())
        except (rospy.ROSException, rospy.ServiceException, OSError) as error:
            self._answer(what, str(error))
        except Exception as error:  # the request's outermost level: the next one is served nevertheless
            self._answer(what, f"{type(error).__name__}: {error}")
            rospy.logerr("%s failed:\n%s", what, traceback.format_exc())
