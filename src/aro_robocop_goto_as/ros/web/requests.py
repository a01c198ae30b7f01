"""Visitors' requests as messages and service calls, made by one thread, so that no caller waits for a service."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict

import rospy

from ...names import SIMULATOR, absolute
from ...web.state import SharedState
from ..waiting import wait_until

SERVICE_TIMEOUT, CONNECT_TIMEOUT = 10.0, 2.0  # [s, wall] for a service to appear, for a subscriber to connect


class Requests:
    """Carries out one request after the other; the state says why the last request failed.

    Requests are ignored if visitors may not send any.
    """

    def __init__(self, state: SharedState) -> None:
        self._state = state
        self._worker = ThreadPoolExecutor(1)
        self._publishers: Dict[str, rospy.Publisher] = {}

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
        def carry_out() -> None:
            try:
                problem = job()
            except (rospy.ROSException, rospy.ServiceException, OSError) as error:
                problem = str(error)
            self._state.change(answer=f"{what}: {problem}" if problem else "")

        if self._state.now.can_send:
            self._worker.submit(carry_out)
