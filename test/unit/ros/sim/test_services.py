"""How services answer."""

from typing import Any, Dict

from aro_robocop_goto_as.errors import ShutdownError
from aro_robocop_goto_as.ros.sim.services import serve


def test_request_that_comes_while_the_simulator_ends_is_answered_with_the_reason() -> None:
    def answer(_: Any) -> Dict[str, Any]:
        raise ShutdownError("the simulator is shutting down")

    offered: Dict[str, Any] = {}
    serve("~pause", None, answer, offer=lambda name, _, respond: offered.update({name: respond}))
    assert offered["~pause"](None) == {"success": False, "message": "the simulator is shutting down"}
