"""The failed checks of a recording, from the report beside it."""

import json
from pathlib import Path
from typing import Any, Dict, Optional

import pytest

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.ros.web.replay import Failure, beginning_of, failures


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


def test_the_start_of_a_replay_is_a_little_before_the_failure_and_not_before_the_recording() -> None:
    assert Failure("late", 31.25, "").start == "30.2"
    assert Failure("early", 0.4, "").start == "0.0"


@pytest.mark.parametrize("content", [None, b"no bag"])
def test_a_file_that_is_no_bag_is_refused_by_name(tmp_path: Path, content: Optional[bytes]) -> None:
    if content is not None:
        (tmp_path / "x.bag").write_bytes(content)
    with pytest.raises(ParameterError, match=f"replay: {tmp_path}/x.bag"):
        beginning_of(str(tmp_path / "x.bag"))
