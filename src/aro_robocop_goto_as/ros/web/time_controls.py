"""The controls of simulated time."""

import time
from typing import Any

from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from std_srvs.srv import Trigger

from aro_robocop_goto_as.srv import Reset

from ...web.state import PageState
from .part import Context, Part

SETTLED = 2.0  # [s, wall] after a visitor has moved the slider: until then what is reported may be older than that


class TimePart(Part):
    """Pause, run, reset (with the same seed) and the real-time factor; hidden where there is no simulator."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, call = context.server.gui, context.requests.call
        act = {
            "Pause": lambda: call("pause", "pause", Trigger),
            "Run": lambda: call("continue", "unpause", Trigger),
            "Reset": lambda: call("reset", "reset", Reset, 0),
        }
        self._folder = gui.add_folder("Time", visible=False)
        with self._folder:
            gui.add_button_group("Simulation", tuple(act)).on_click(lambda event: act[event.target.value]())
            self._factor = gui.add_slider("Factor", 0.1, 10.0, 0.1, 1.0, hint="simulated seconds per second")
        self._moved_at = 0.0  # [s, wall]

        async def on_update(event: Any) -> None:  # a coroutine: in viser's thread pool it could come late
            if event.client is not None:
                self._moved_at, factor = time.monotonic(), event.target.value
                config = Config(doubles=[DoubleParameter("real_time_factor", factor)])
                call(f"factor {factor:g}", "set_parameters", Reconfigure, config)

        self._factor.on_update(on_update)

    def show(self, state: PageState) -> None:
        self._folder.visible = state.can_send and state.simulated
        if state.factor_asked > 0.0 and time.monotonic() - self._moved_at > SETTLED:
            self._factor.value = min(max(state.factor_asked, self._factor.min), self._factor.max)
