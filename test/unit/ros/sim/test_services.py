"""How services answer."""

from aro_robocop_goto_as.errors import ShutdownError
from aro_robocop_goto_as.ros.sim.services import serve


def test_request_that_comes_while_the_simulator_ends_is_answered_with_the_reason():
    def answer(_):
        raise ShutdownError("the simulator is shutting down")

    offered = {}
    serve("~pause", None, answer, offer=lambda name, _, respond: offered.update({name: respond}))
    assert offered["~pause"](None) == {"success": False, "message": "the simulator is shutting down"}
