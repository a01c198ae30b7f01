"""The controls of a recording: play, pause, time and speed."""

import time
from dataclasses import dataclass
from typing import Any, Callable

from . import text
from .panel_html import Html
from .state import ReplayState

PLAY, PAUSE = "Play", "Pause"
SETTLED = 2.0  # [s, wall] after a visitor has moved a slider: until then what is reported may be older than that
STEP = 0.1  # [s, recorded] of the slider


@dataclass(frozen=True)
class Replay:
    """A recording that is shown instead of a running system, and what the page asks for; none may block."""

    duration: float  # [s, recorded]
    speed: float  # at the beginning
    play: Callable[[bool], None]  # or pause
    seek: Callable[[float], None]  # to a moment [s, recorded]
    set_speed: Callable[[float], None]


class ReplayPanel:
    """Built once in the panel `gui` of a viser server, and shared by all browsers."""

    def __init__(self, gui: Any, replay: Replay) -> None:
        self._replay = replay
        self._moved = 0.0  # [s, wall] when a visitor moved the slider
        self._progress = Html(gui.add_html(""))
        buttons = gui.add_button_group("Recording", (PLAY, PAUSE))
        buttons.on_click(lambda event: replay.play(event.target.value == PLAY))
        longest = max(round(replay.duration, 1), STEP)
        self._moment = gui.add_slider("Time", 0.0, longest, STEP, 0.0, hint="seconds since the beginning")
        self._moment.on_update(self._on_moment)
        speed = gui.add_slider("Speed", 0.1, 10.0, 0.1, replay.speed, hint="recorded seconds per second")
        speed.on_update(lambda event: replay.set_speed(event.target.value))

    async def _on_moment(self, event: Any) -> None:  # a coroutine: in viser's thread pool it could come late
        if event.client is not None:
            self._moved = time.monotonic()
            self._replay.seek(event.target.value)

    def show(self, state: ReplayState) -> None:
        """How far the recording has been played."""
        self._progress.show(text.progress(state))
        moment = min(round(state.position, 1), self._moment.max)
        if time.monotonic() - self._moved > SETTLED and abs(self._moment.value - moment) > STEP / 2.0:
            self._moment.value = moment
