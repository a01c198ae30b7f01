"""Gazebo's services, for nodes that wait for them; their types exist if the hand-in was built on top of compat/."""

import contextlib
import io
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Tuple

from aro_robocop_goto_as.simulation.running import Simulation

from ..agent import wire
from .topics import header

REFUSAL = "the judge decides where the robot and the models of the world are"  # to calls that change them
LOOK = 0.001  # [s, wall]


class Services:
    """What the node can call; the thread that owns the simulation answers."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._thread = ThreadPoolExecutor(1)  # services ask the owner
        self._offered: Dict[str, Tuple[Any, Callable[[Any], Any]]] = {}
        with contextlib.suppress(ImportError):
            from aro_robocop_goto_as.ros.sim.gazebo_services import GazeboServices

            GazeboServices(simulation, None, REFUSAL, self._offer)

    def _offer(self, name: str, kind: Any, answer: Callable[[Any], Any]) -> None:
        self._offered[name] = kind, answer

    def headers(self) -> List[Dict[str, str]]:
        """What their connections begin with."""
        return [header(kind, service=name) for name, (kind, _) in self._offered.items()]

    def call(self, name: str, request: bytes) -> bytes:
        """The response to a serialized request, both as on TCPROS."""
        body = io.BytesIO()
        try:
            kind, answer = self._offered[name]
            future = self._thread.submit(answer, kind._request_class().deserialize(request[wire.LENGTH.size :]))
            while not future.done():
                self._simulation.jobs.run_next(LOOK)
            response = future.result()
            if isinstance(response, dict):
                response = kind._response_class(**response)
            elif isinstance(response, tuple):
                response = kind._response_class(*response)
            response.serialize(body)
        except Exception as error:  # whatever it is, as rospy
            text = f"error processing request: {error}".encode()
            return b"\0" + wire.LENGTH.pack(len(text)) + text
        return b"\1" + wire.LENGTH.pack(body.tell()) + body.getvalue()
