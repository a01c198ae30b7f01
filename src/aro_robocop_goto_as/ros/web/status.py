"""Problems, the state of simulator and server, the answer to the last request, the choice of the robot."""

import time
from typing import Any, List, Optional, Tuple

import rospy
from std_msgs.msg import String

from aro_robocop_goto_as.msg import SimStatus

from ...names import ACTION, BRIDGE, SIMULATOR, absolute
from ...web import text
from ...web.state import PageState
from .. import graph
from ..connected_nodes import publishers_of
from .part import Context, Inbox, Part

SILENCE_TIMEOUT = 4.0  # [s, wall] the simulator, which reports once per second, counts as gone after it
READY = (f"{ACTION} is ready", "goal x ")  # how the bridge's reports of a server that answers begin


class StatusPart(Part):
    """The top of the panel."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui = context.server.gui
        self._alert, self._overview, self._answer = (gui.add_html("") for _ in range(3))
        self._robot = gui.add_dropdown("Robot", ("",), visible=False, hint="shown in detail and driven")
        self._sim: Optional[SimStatus] = None
        self._sim_at = 0.0  # [s, wall]
        self._bridge = ""
        self._reports: Optional[rospy.Subscriber] = None  # to the bridge's status
        self._no_simulator = ""  # that none runs, as long as none has reported

        async def on_select(event: Any) -> None:  # a coroutine: in viser's thread pool it could come late
            if event.client is not None:
                context.state.change(chosen=event.target.value, executing=None, answering=False)

        self._robot.on_update(on_select)

    def subscribe(self, inbox: Inbox) -> None:
        inbox.subscribe(absolute(SIMULATOR, "status"), SimStatus, self._on_sim)

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        self._bridge = ""
        self._reports = inbox.subscribe(absolute(robot, f"{BRIDGE}/status"), String, self._on_bridge)

    def _on_sim(self, at: float, message: SimStatus) -> None:
        self._sim, self._sim_at = message, at
        self.context.state.change(simulated=True, factor_asked=message.factor_asked)

    def _on_bridge(self, _: float, message: String) -> None:
        self._bridge = message.data

    def ask_master(self, state: PageState) -> None:
        asked = state.can_send and self._sim is None and self.context.server.get_clients()  # a visitor may have to wait
        self._no_simulator = graph.no_simulator() if asked else ""

    def show(self, state: PageState) -> None:
        """Show all of it; a recording's simulator may be silent for as long as it is paused."""
        if self._bridge and not state.recorded and self._reports is not None and not publishers_of(self._reports):
            self._bridge = ""  # it is gone
        silence = 0.0 if self._sim is None or state.recorded else time.monotonic() - self._sim_at
        gone = f"No report from the simulator for {silence:.0f} s: has it ended?"
        problem = gone if silence > SILENCE_TIMEOUT else self._no_simulator or self._slip()
        self._alert.content = text.alert(problem)
        known = state.can_send or self._sim is not None or self._bridge  # the recording of a grading has neither
        self._overview.content = text.table(self._rows(state)) if known else ""
        self._answer.content = text.answer(state.answer)
        if self._robot.options != state.robots:
            self._robot.options = state.robots
        self._robot.value = state.selected
        self._robot.visible = len(state.robots) > 1

    def _rows(self, state: PageState) -> List[Tuple[str, str]]:
        rows, sim = [], self._sim
        if sim is not None:
            speed = "paused" if sim.paused else f"factor {sim.factor_reached:.2f}"
            rows += [("world", sim.world), ("time", f"{sim.stamp.to_sec():.0f} s, {speed}")]
        answers = "answers, no report from the bridge" if state.answering else "does not publish its status"
        report = "ready" if self._bridge.startswith(READY) else self._bridge
        return [*rows, ("server", "executes a goal" if state.executing else report or answers)]

    def _slip(self) -> str:
        """What to know of robots whose odometry is wrong; empty if there are none."""
        if self._sim is None or not self._sim.slipped:
            return ""
        robots = " and ".join(filter(None, self._sim.slipped))
        return (
            f"The wheels {robots and f'of {robots} '}slipped at an obstacle: odometry is wrong, and goals lead "
            "elsewhere. Reset puts robots and their odometry back."
        )
