"""Gazebo's services, for nodes that wait for them; their types exist if the hand-in was built on top of compat/."""

import contextlib
import io
from typing import Any, Callable, Dict, List, Tuple

from aro_robocop_goto_as.simulation.simulator import Simulator

from ..agent import wire
from .topics import header

REFUSAL = "the judge decides where the robot and the models of the world are"  # to calls that change them


class Services:
    """The services that the node can call."""

    def __init__(self, simulator: Simulator) -> None:
        self._offered: Dict[str, Tuple[Any, Callable[[Any], Any]]] = {}
        with contextlib.suppress(ImportError):
            from aro_robocop_goto_as.ros.sim.gazebo_services import GazeboServices

            # The thread that owns the simulator answers the node's requests itself.
            GazeboServices(simulator, lambda function: function(), None, REFUSAL, self._offer)

    def _offer(self, name: str, kind: Any, answer: Callable[[Any], Any]) -> None:
        self._offered[name] = kind, answer

    def headers(self) -> List[Dict[str, str]]:
        """The headers with which connections to the services begin."""
        return [header(kind, service=name) for name, (kind, _) in self._offered.items()]

    def call(self, name: str, request: bytes) -> bytes:
        """The response to a serialized request, both as on TCPROS."""
        body = io.BytesIO()
        try:
            kind, answer = self._offered[name]
            response = answer(kind._request_class().deserialize(request[wire.LENGTH.size :]))
            if isinstance(response, dict):
                response = kind._response_class(**response)
            elif isinstance(response, tuple):
                response = kind._response_class(*response)
            response.serialize(body)
        except Exception as error:  # whatever it is, as rospy
            text = f"error processing request: {error}".encode()
            return b"\0" + wire.LENGTH.pack(len(text)) + text
        return b"\1" + wire.LENGTH.pack(body.tell()) + body.getvalue()
