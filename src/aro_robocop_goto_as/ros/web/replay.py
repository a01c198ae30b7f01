"""The controls of a recording: play, pause, time and speed, and the checks that failed in it, from its report."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, List, Sequence

from ...web import text
from ...web.slider import Slider
from ...web.state import PageState
from .part import Context, Part
from .player import Player

PLAY, PAUSE = "Play", "Pause"
BEFORE = 1.0  # [s, recorded] before a failure, from where on it is shown


@dataclass(frozen=True)
class Failure:
    """A failed check: when [s, after the recording's beginning], and what was wrong."""

    check: str
    time: float
    text: str


class Replay(Part):
    """Only a page that shows a recording has this part."""

    def __init__(self, context: Context, player: Player, failed: Sequence[Failure], speed: float) -> None:
        """speed: at the beginning"""
        super().__init__(context)
        gui = context.server.gui
        self._player, self._failed = player, failed
        self._progress = gui.add_html("")
        buttons = gui.add_button_group("Recording", (PLAY, PAUSE))
        buttons.on_click(lambda event: player.play(event.target.value == PLAY))
        longest = max(round(player.duration, 1), 0.1)
        self._time = Slider(gui, "Time", longest, 0.0, "seconds since the beginning", player.seek, low=0.0)
        Slider(gui, "Speed", 10.0, speed, "recorded seconds per second", player.set_speed)

    def add_failures(self) -> None:
        """List the failed checks in the part of the panel that is open now."""
        gui = self.context.server.gui
        for failure in self._failed:
            with gui.add_folder(f"✗ {failure.check}, failed at {failure.time:.1f} s"):
                gui.add_html(text.answer(failure.text))
                gui.add_button("Show the moment", icon="player-skip-back").on_click(self._to(failure))

    def _to(self, failure: Failure) -> Callable[[Any], None]:
        return lambda _: self._player.seek(max(failure.time - BEFORE, 0.0))

    def show(self, state: PageState) -> None:
        position, speed = self._player.position, self._player.speed
        how = f"factor {speed:g}" if speed else "paused"
        rows = [("recording", f"{position:.0f} of {self._player.duration:.0f} s, {how}")]
        if self._failed:  # the causes of its failures name times, too
            rows.append(("in the report", f"{self._player.beginning + position:.1f} s"))
        self._progress.content = text.table(rows)
        self._time.show(round(position, 1))


def failures(bag: str, beginning: float) -> List[Failure]:
    """Those of the scenario that PART-SCENARIO.bag shows, in order of time; none without a report beside it.

    beginning: of the recording [s]; a report's times are of the same clock, which goes on from scenario to scenario
    """
    path = Path(bag)
    try:
        checks = json.loads((path.parent / "report.json").read_text(encoding="utf-8"))["checks"]
        failed = [check for check in checks if check["failure"] and f"{check['part']}-{check['scenario']}" == path.stem]
        found = [_failure(check, beginning) for check in failed]
    except (OSError, ValueError, KeyError, TypeError):  # no report, or another file of this name
        return []
    return sorted(found, key=lambda failure: failure.time)


def _failure(check: Any, beginning: float) -> Failure:
    failure = check["failure"]
    text = f"{_sentence(failure['cause'])} Expected {failure['expected']}, got {_sentence(failure['seen'])}"
    return Failure(str(check["name"]), float(failure["time"]) - beginning, text)


def _sentence(text: str) -> str:
    return text if text.endswith((".", "?", "!")) else f"{text}."
