"""The failed checks of a recording, from the report beside it, and where it says that it is."""

import json
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple
from unittest.mock import MagicMock

import pytest

from aro_robocop_goto_as.ros.web.replay import Failure, Replay, failures
from aro_robocop_goto_as.web.state import PageState


def check(name: str, scenario: str, time: Optional[float]) -> Dict[str, Any]:
    failure = None if time is None else {"expected": "A", "seen": "B", "time": time, "cause": "Why"}
    return {"name": name, "part": "server", "scenario": scenario, "failure": failure}


def test_the_checks_that_failed_in_the_scenario_of_the_bag_are_found_in_order_of_time(tmp_path: Path) -> None:
    checks = [check("late", "left", 73.0), check("early", "left", 66.0), check("passed", "left", None)]
    (tmp_path / "report.json").write_text(json.dumps({"checks": [*checks, check("elsewhere", "right", 65.0)]}))
    found = failures(str(tmp_path / "server-left.bag"), 64.0)
    assert [failure.check for failure in found] == ["early", "late"]
    assert found[0] == Failure("early", 2.0, "Why. Expected A, got B.")
    assert failures(str(tmp_path / "bridge-left.bag"), 64.0) == []


@pytest.mark.parametrize("content", [None, "", "[]", "{}", '{"checks": [{}]}', '{"checks": 3}'])
def test_there_are_none_without_a_report_or_with_another_file_of_its_name(tmp_path: Path, content: str) -> None:
    if content is not None:
        (tmp_path / "report.json").write_text(content)
    assert failures(str(tmp_path / "server-left.bag"), 0.0) == []


@pytest.mark.parametrize(
    "position, speed, text", [(12.3, 0.5, "12 of 60 s, factor 0.5"), (60.0, 0.0, "60 of 60 s, paused")]
)
def test_a_recording_says_where_it_is_and_how_fast_it_goes(position: float, speed: float, text: str) -> None:
    content, slider = shown([], position, speed)
    assert text in content and slider.value == position
    assert "report" not in content


def test_a_recording_with_failed_checks_says_which_time_of_the_report_is_shown() -> None:
    content, _ = shown([Failure("stops", 15.0, "")], 12.3, 1.0)
    assert "in the report" in content and "76.3 s" in content


def shown(failed: List[Failure], position: float, speed: float) -> Tuple[str, MagicMock]:
    """The text at the top, and the time's slider, of a recording of 60 s that begins at 64 s."""
    context, slider = MagicMock(), MagicMock(min=0.0, max=60.0)
    context.server.gui.add_slider.return_value = slider
    progress = context.server.gui.add_html.side_effect = [MagicMock() for _ in range(1 + len(failed))]
    player = MagicMock(position=position, speed=speed, duration=60.0, beginning=64.0)
    Replay(context, player, failed, 1.0).show(PageState())
    return progress[0].content, slider
