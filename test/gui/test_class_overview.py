"""The overview of a large class in a real browser: it is searched and sorted, and shows as many rows as asked for."""

from pathlib import Path

import pytest

from robocop_grading.classroom.results import SHOWN, StoredGrade, page
from robocop_grading.grades import CheckOutcome, CheckResult
from robocop_grading.plan_file import load

PLAN = load(Path(__file__).resolve().parents[2] / "config" / "grading.yaml")
COUNT = SHOWN + 100
NAMES = "() => [...document.querySelectorAll('#hand_ins tbody tr:not([hidden])')].map(row => row.cells[0].innerText)"


@pytest.mark.slow
def test_overview_is_searched_sorted_and_shown_in_full(tmp_path, browser):
    results = [
        StoredGrade(
            f"s{number:03}", (CheckResult("cancel", "server", "", CheckOutcome.PASSED, float(number % 7), 7.0, False),)
        )
        for number in range(COUNT)
    ]
    (tmp_path / "index.html").write_text(page("class", results, PLAN, {"zoe": "waiting"}, running=False))
    tab, errors = browser.new_page(), []
    tab.on("pageerror", lambda error: errors.append(str(error)))
    tab.goto(f"file://{tmp_path}/index.html")
    assert tab.evaluate(NAMES) == [f"s{number:03}" for number in range(SHOWN)]
    tab.click("#more")
    assert len(tab.evaluate(NAMES)) == COUNT + 1
    points = tab.locator("#hand_ins thead th").nth(1)
    points.click()
    points.click()
    assert tab.evaluate(NAMES)[:2] == ["s006", "s013"], "the most points first, then by name"
    tab.fill("#find", "S29")
    assert tab.evaluate(NAMES) == ["s293", "s292", "s299", "s291", "s298", "s290", "s297", "s296", "s295", "s294"]
    tab.reload()
    assert tab.evaluate(NAMES)[0] == "s293", "search and order are kept when the page is loaded again"
    assert errors == []
