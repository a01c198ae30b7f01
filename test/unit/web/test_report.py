"""The failed checks of a recording, from the report beside it."""

import json
from pathlib import Path
from typing import Any, Dict, Optional

import pytest

from aro_robocop_goto_as.web.report import Failure, failures


def check(name: str, scenario: str, time: Optional[float]) -> Dict[str, Any]:
    failure = None if time is None else {"expected": "A", "seen": "B", "time": time, "cause": "Why."}
    return {"name": name, "part": "server", "scenario": scenario, "failure": failure}


def test_the_checks_that_failed_in_the_scenario_of_the_bag_are_found_in_order_of_time(tmp_path: Path) -> None:
    checks = [check("late", "left", 9.0), check("early", "left", 2.0), check("passed", "left", None)]
    (tmp_path / "report.json").write_text(json.dumps({"checks": [*checks, check("elsewhere", "right", 1.0)]}))
    found = failures(str(tmp_path / "server-left.bag"))
    assert [failure.check for failure in found] == ["early", "late"]
    assert found[0] == Failure("early", 2.0, "Why. Expected A, got B.")
    assert failures(str(tmp_path / "bridge-left.bag")) == []


@pytest.mark.parametrize("content", [None, "", "[]", "{}", '{"checks": [{}]}', '{"checks": 3}'])
def test_there_are_none_without_a_report_or_with_another_file_of_its_name(tmp_path: Path, content: str) -> None:
    if content is not None:
        (tmp_path / "report.json").write_text(content)
    assert failures(str(tmp_path / "server-left.bag")) == []
