"""The controls of a recording: play, pause, time and speed."""

from typing import Callable, Sequence

from ...web import text
from ...web.elements import Html, Slider, add_button
from ...web.report import Failure
from ...web.state import PageState
from .part import Context, Part
from .player import Player

PLAY, PAUSE = "Play", "Pause"
BEFORE = 1.0  # [s, recorded] before a failure, from where on it is shown


class Replay(Part):
    """Only a page that shows a recording has this part."""

    def __init__(self, context: Context, player: Player, failed: Sequence[Failure]) -> None:
        super().__init__(context)
        gui, start = context.server.gui, player.state
        self._player = player
        self._progress = Html(gui)
        buttons = gui.add_button_group("Recording", (PLAY, PAUSE))
        buttons.on_click(lambda event: player.play(event.target.value == PLAY))
        longest = max(round(start.duration, 1), 0.1)
        self._time = Slider(gui, "Time", longest, 0.0, "seconds since the beginning", player.seek, low=0.0)
        Slider(gui, "Speed", 10.0, start.speed, "recorded seconds per second", player.set_speed)
        for failure in failed:
            with gui.add_folder(f"✗ {failure.check}, failed at {failure.time:.1f} s"):
                Html(gui).show(text.answer(failure.text))
                add_button(gui, "Show the moment", "player-skip-back", self._to(failure))

    def _to(self, failure: Failure) -> Callable[[], None]:
        return lambda: self._player.seek(max(failure.time - BEFORE, 0.0))

    def show(self, state: PageState) -> None:
        replay = self._player.state
        self._progress.show(text.progress(replay))
        self._time.show(round(replay.position, 1))
