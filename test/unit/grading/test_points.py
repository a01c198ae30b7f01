"""Points are counted in one way: what is scored of what is available, and extra points apart from it, everywhere."""

import json
import re
from dataclasses import replace

import pytest
from grading_records import PLAN

from robocop_grading.checks import Failed
from robocop_grading.classroom.table import table
from robocop_grading.cli import in_short, progress
from robocop_grading.grades import CheckOutcome, CheckResult, Grade, completed
from robocop_grading.report.write import as_classroom, as_gradescope, as_json, write
from robocop_grading.scenarios import BRIDGE_SCENARIOS

MISTAKE = Failed("a goal", "none", 1.0, "No goal was sent.")
FORWARDS = CheckResult("forwards_goal", "bridge", "A click is a goal.", CheckOutcome.PASSED, 2.0, 2.0, False)
FRAME = CheckResult("goal_frame", "bridge", "Frames are transformed.", CheckOutcome.PASSED, 1.0, 1.0, True)


def failed(check):
    """The check, failed."""
    return replace(check, outcome=CheckOutcome.FAILED, points=0.0, failure=MISTAKE)


def blocked(check, by):
    """The check, not reached because another one failed."""
    return replace(check, outcome=CheckOutcome.NOT_REACHED, points=0.0, follows=by.name, why="no goal")


@pytest.mark.parametrize(
    "checks, words",
    [
        ((FORWARDS, FRAME), "2 of 2 points, 1 of 1 extra"),
        ((FORWARDS, failed(FRAME)), "2 of 2 points, 0 of 1 extra"),
        ((failed(FORWARDS), FRAME), "0 of 2 points, 1 of 1 extra"),
        ((FORWARDS,), "2 of 2 points"),
        ((FRAME,), "1 of 1 extra"),
        ((), "nothing was judged"),
    ],
)
def test_extra_points_are_told_apart_from_the_others(checks, words, tmp_path):
    grade = Grade("anna", checks)
    assert grade.words == words
    assert in_short(grade)[-1] == f"anna: {words}"
    write(grade, PLAN, {}, tmp_path)
    assert words in (tmp_path / "report.html").read_text()
    values = as_json(grade, PLAN)
    points, extra = sum(it.points for it in checks if not it.extra), sum(it.points for it in checks if it.extra)
    assert (values["points"], values["extra"]) == (points, extra)
    assert as_gradescope(grade)["score"] == points + extra, "Gradescope adds extra credit to the score"


@pytest.mark.parametrize(
    "checks, cost",
    [
        ((failed(FORWARDS), blocked(FRAME, FORWARDS)), "2 points and 1 extra"),
        ((failed(FORWARDS), FRAME), "2 points"),
        ((FORWARDS, failed(FRAME)), "1 extra"),
        ((failed(replace(FORWARDS, points_available=1.0)),), "1 point"),
        ((failed(replace(FORWARDS, points_available=0.0)),), "0 points"),
    ],
)
def test_cost_of_a_mistake_names_extra_points_apart(checks, cost, tmp_path):
    grade = Grade("anna", checks)
    assert [mistake.cost for mistake in grade.mistakes] == [cost]
    assert f" costs {cost}: No goal was sent." in in_short(grade)[0]
    write(grade, PLAN, {}, tmp_path)
    assert re.search(f"costs {cost}<", (tmp_path / "report.html").read_text())


def test_mistake_that_costs_only_an_extra_point_is_fixed_last():
    grade = Grade("anna", (failed(replace(FRAME, points_available=3.0)), failed(FORWARDS)))
    assert [mistake.check.name for mistake in grade.mistakes] == ["forwards_goal", "goal_frame"]


def test_every_list_marks_extra_checks_and_adds_up_the_others_only(tmp_path):
    checks = failed(FORWARDS), blocked(replace(FORWARDS, name="b"), FORWARDS), blocked(FRAME, FORWARDS)
    (mistake,) = Grade("anna", checks).mistakes
    assert mistake.consequences == "not reached because of it: b, goal_frame (extra)"
    write(Grade("anna", (failed(FORWARDS), replace(FORWARDS, name="b"), FRAME)), PLAN, {}, tmp_path)
    assert re.search(r"2 passed</span>,\s*2 / 2 points", (tmp_path / "report.html").read_text())
    for listed in (as_classroom(Grade("anna", (FRAME,))), as_gradescope(Grade("anna", (FRAME,)))):
        assert "Frames are transformed. (extra)" in str(listed)


def test_part_that_is_not_handed_in_counts_the_same_in_every_report(tmp_path):
    server = [it for it in PLAN.checks if it.part == "server"]
    checks = [CheckResult(it.name, "server", "", CheckOutcome.PASSED, it.points, it.points, it.extra) for it in server]
    grade = completed(Grade("anna", tuple(checks)), PLAN)
    server = round(sum(check.points for check in PLAN.checks if check.part == "server"), 6)
    words = f"{server:g} of {PLAN.points:g} points, 0 of {PLAN.extra:g} extra"
    assert not grade.all_right and grade.words == words
    write(grade, PLAN, {}, tmp_path)
    for text in ("\n".join(in_short(grade)), (tmp_path / "report.html").read_text()):
        assert words in text and "not handed in: the bridge" in text
    assert json.loads((tmp_path / "report.json").read_text())["of"] == PLAN.points
    assert json.loads((tmp_path / "classroom.json").read_text())["max_score"] == PLAN.points
    tests = json.loads((tmp_path / "results.json").read_text())["tests"]
    assert sum(test.get("max_score", 0.0) for test in tests) == pytest.approx(PLAN.points)
    row = table([Grade("anna", grade.checks)], PLAN).splitlines()[1]
    assert row.startswith(f"anna,{server},{PLAN.points},0.0,{server},not handed in,")


def test_progress_counts_the_scenarios_of_the_parts_that_are_graded(capsys):
    def told(plan, *parts):
        for part in parts:
            progress(plan, parts)(part, plan.scenarios_of(part)[-1])
        return capsys.readouterr().err

    servers, bridges = len(PLAN.scenarios) + 1, len(BRIDGE_SCENARIOS)
    both = servers + bridges
    assert told(PLAN, "server", "bridge") == (
        f"{servers}/{both} server: {PLAN.scenarios[-1].name}\n{both}/{both} bridge: frame\n"
    )
    assert told(PLAN, "bridge") == f"{bridges}/{bridges} bridge: frame\n"
    assert told(PLAN.restricted(["waits_for_server"]), "bridge") == "2/2 bridge: click\n"
