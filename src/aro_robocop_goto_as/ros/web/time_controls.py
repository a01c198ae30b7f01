"""The controls of simulated time."""

from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from std_srvs.srv import Trigger

from aro_robocop_goto_as.srv import Reset

from ...web.slider import Slider
from ...web.state import PageState
from .part import Context, Part


class TimeControls(Part):
    """Pause, run, reset (with the same seed) and the real-time factor; hidden where there is no simulator."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, call = context.server.gui, context.requests.call
        act = {
            "Pause": lambda: call("pause", "pause", Trigger),
            "Run": lambda: call("continue", "unpause", Trigger),
            "Reset": self._reset,
        }
        self._folder = gui.add_folder("Time", visible=False)
        with self._folder:
            gui.add_button_group("Simulation", tuple(act)).on_click(lambda event: act[event.target.value]())
            self._factor = Slider(gui, "Factor", 10.0, 1.0, "simulated seconds per second", self._set_factor)

    def _reset(self) -> None:
        self.context.requests.call("reset", "reset", Reset, 0)
        self.context.state.change(resets=self.context.state.now.resets + 1)

    def _set_factor(self, factor: float) -> None:
        config = Config(doubles=[DoubleParameter("real_time_factor", factor)])
        self.context.requests.call(f"factor {factor:g}", "set_parameters", Reconfigure, config)

    def show(self, state: PageState) -> None:
        self._folder.visible = state.live and state.simulated
        if state.factor_asked > 0.0:
            self._factor.show(state.factor_asked)
