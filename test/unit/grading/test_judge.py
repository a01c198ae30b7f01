"""Outcomes, points, and what follows from what."""

import math
from dataclasses import replace
from typing import Any, Dict, Tuple, cast

import pytest
from grading_records import GOAL, PLAN, RIGHT, changed, commanded, fed_back

from robocop_grading import record as rec
from robocop_grading.judge import Outcome, judge
from robocop_grading.plan import Plan
from robocop_grading.plan_file import load
from robocop_grading.record import Record
from robocop_grading.report.write import as_classroom, as_gradescope


def test_server_that_never_succeeds_is_not_blamed_for_odd_ranges() -> None:
    stuck = changed(goals=(GOAL,), results=(), problem="the robot made no progress for 8 s, and the goal did not end")
    records = {"server": {"left": stuck, "odd_scan": replace(stuck, name="odd_scan")}}
    checks = {check.name: check for check in judge("anna", load(PLAN), records, {}).checks}
    odd = checks["odd_scans"].failure
    assert odd is not None and odd.cause.startswith("This follows from another failed check") and "NaN" not in odd.cause


def test_exception_in_a_click_callback_is_named_as_the_cause_of_a_missing_goal() -> None:
    lines = ("bad callback: <goal_cb>", "Traceback (most recent call last):", "AttributeError: no attribute 'x'")
    click = rec.Click(1.0, "odom", 1.2, -0.4, 1.2, -0.4)
    record = changed(goals=(), clicks=(click,), lines=tuple(rec.Line(2.0, line) for line in lines))
    record = replace(record, name="click", part="bridge")
    checks = {check.name: check for check in judge("anna", load(PLAN), {"bridge": {"click": record}}, {}).checks}
    crash = checks["bridge_alive"].failure
    assert crash is not None and "AttributeError: no attribute 'x'" in crash.cause
    assert checks["forwards_goal"].follows == "bridge_alive"
    assert "wait_for_server" not in checks["waits_for_server"].words


def test_wall_that_was_hit_without_odd_ranges_is_not_blamed_on_them() -> None:
    goal = replace(GOAL, ends="ABORTED")
    hit = changed(goals=(goal,))
    records = {"server": {"obstacle": hit, "odd_scan_wall": replace(hit, name="odd_scan_wall")}}
    checks = {check.name: check for check in judge("anna", load(PLAN), records, {}).checks}
    first, odd = checks["stops_at_obstacle"].failure, checks["odd_scans"].failure
    assert first is not None and odd is not None
    assert odd.cause.startswith('This follows from another failed check: "An obstacle closer than')
    assert "NaN" not in odd.cause
    assert checks["odd_scans"].follows == "stops_at_obstacle"
    alone = judge("anna", load(PLAN), {"server": {"odd_scan_wall": hit}}, {})
    cause = next(check.failure for check in alone.checks if check.name == "odd_scans")
    assert cause is not None and "NaN hides the wall" in cause.cause


def test_what_a_wrong_error_leads_to_follows_from_it_and_another_mistake_does_not() -> None:
    early = (rec.Result(5.0, "g", rec.SUCCEEDED, True, "there"),)
    misled = replace(fed_back(position=lambda d: d / 20.0), results=early)
    still_driving = {"stands_at_end": ""}
    assert _failures(misled) == {"feedback_position": "", "reaches_goal": "feedback_position", **still_driving}
    unrelated = replace(fed_back(position=lambda _: 1.0), results=early)  # its feedback did not say that it was there
    assert _failures(unrelated) == {"feedback_position": "", "reaches_goal": "", **still_driving}


def test_robot_that_acts_on_its_wrong_angle_turns_wrongly_because_of_that() -> None:
    wrong = replace(fed_back(angle=lambda a: -a), commands=commanded(lambda c: replace(c, w=-c.w)).commands)
    assert _failures(wrong) == {"feedback_angle": "", "turns_to_goal": "feedback_angle"}
    assert _failures(commanded(lambda c: replace(c, w=-c.w))) == {"turns_to_goal": ""}
    partly = commanded(lambda c: replace(c, w=-c.w, v=c.v if c.time < 6.0 else 0.0)).commands
    own = {"feedback_angle": "", "turns_to_goal": "", "drives_straight": ""}
    assert _failures(replace(wrong, commands=partly)) == own, "of its commands 40 % do not fit its angle"


def test_cause_of_wrong_feedback_fits_in_all_scenarios() -> None:
    rounded = fed_back(position=round)
    shorter = _cause("feedback_position", left=fed_back(position=lambda d: d / math.sqrt(2.0)))
    assert shorter.count("; or: ") == 2 and all(word in shorter for word in ("is |dx|", "is |dy|", "larger one"))
    assert "rounded to a whole number" in _cause("feedback_position", left=rounded)
    assert "is not the distance" in _cause("feedback_position", left=rounded, right=RIGHT)


def test_pose_that_never_changes_is_explained_by_the_topic_that_nobody_publishes() -> None:
    goals = {"left": GOAL, "right": replace(GOAL, x=-1.0)}
    records = {name: changed(goals=(goal,), feedback=_unturned(goal)) for name, goal in goals.items()}
    assert "as if the heading stayed 0" in _cause("feedback_angle", **records)
    start = Record("start", "server", unpublished=("/odometry/filtered", "/laser"))
    assert "subscribes to /odometry/filtered" in _cause("feedback_angle", start=start, **records)


def _unturned(goal: rec.Goal) -> Tuple[rec.Feedback, ...]:
    """The feedback of a server that leaves out the heading."""
    errors = (rec.errors_at(replace(at, yaw=0.0), goal) for at in RIGHT.samples)
    return tuple(replace(it, position_error=d, angle_error=a) for it, (d, a) in zip(RIGHT.feedback, errors))


def _cause(check: str, **records: Record) -> str:
    grade = judge("anna", load(PLAN), {"server": records}, {})
    failure = next(it.failure for it in grade.checks if it.name == check)
    assert failure is not None
    return failure.cause


def _failures(record: Record) -> Dict[str, str]:
    """The failed checks of a scenario, and what each follows from."""
    grade = judge("anna", load(PLAN), {"server": {record.name: record}}, {})
    return {check.name: check.follows for check in grade.checks if check.failure is not None}


def test_node_that_ends_while_starting_has_made_one_mistake_and_the_other_part_has_its_own() -> None:
    lines = rec.Line(0.1, "Traceback (most recent call last):"), rec.Line(0.1, "NameError: name 'x' is not defined")
    dead = Record("start", "server", up=False, lines=lines, deaths=(rec.Death(0.2, 1),))
    bridge = replace(dead, name="no_server", part="bridge")
    records = {"server": {"start": dead}, "bridge": {"no_server": bridge}}
    names = [mistake.check.name for mistake in judge("anna", load(PLAN), records, {}).mistakes]
    assert sorted(names) == ["action_server", "waits_for_server"]


def test_mistake_that_blocks_most_points_comes_first() -> None:
    """As of the empty skeleton."""
    click = rec.Click(1.0, "odom", 1.2, -0.4, 1.2, -0.4)
    records = {
        "server": {"start": Record("start", "server", up=False)},
        "bridge": {"click": Record("click", "bridge", clicks=(click,), marks={"clients": 0.0})},
    }
    first, second = judge("anna", load(PLAN), records, {}).mistakes[:2]
    assert (first.check.name, first.points, first.followers, first.blocked) == ("action_server", 4.9, 0, 19)
    assert second.check.name == "forwards_goal" and second.points < first.points


def test_mistakes_are_sorted_by_the_points_that_they_and_what_follows_from_them_cost() -> None:
    wrong = replace(fed_back(angle=lambda a: -a), commands=commanded(lambda c: replace(c, w=-c.w)).commands)
    wrong = replace(wrong, samples=tuple(replace(sample, v=0.2) for sample in wrong.samples))
    mistakes = judge("anna", load(PLAN), {"server": {"left": wrong}}, {}).mistakes
    found = [(mistake.check.name, mistake.points, mistake.followers) for mistake in mistakes]
    assert found == [("feedback_angle", 0.7, 1), ("stands_at_end", 0.15, 0)]


def _grade(plan: Plan, **records: Record) -> Any:
    return judge("x", plan, {"server": records}, {"server": "time-out: it was at left"})


def test_check_that_passed_names_the_first_scenario_that_it_examined() -> None:
    records = {"server": {"left": RIGHT, "right": replace(RIGHT, name="right")}}
    checks = {check.name: check for check in judge("anna", load(PLAN), records, {}).checks}
    assert (checks["reaches_goal"].outcome, checks["reaches_goal"].scenario) == (Outcome.PASSED, "left")


def test_interrupted_scenario_fails_its_checks_with_the_reason() -> None:
    checks = {check.name: check for check in _grade(load(PLAN), start=replace(RIGHT, name="start")).checks}
    assert checks["action_server"].outcome is Outcome.PASSED
    assert checks["reaches_goal"].outcome is Outcome.FAILED
    assert "time-out: it was at left" in checks["reaches_goal"].words


def test_only_submitted_parts_are_graded() -> None:
    grade = judge("x", load(PLAN), {"server": {"start": replace(RIGHT, name="start")}}, {})
    assert grade.points_available == 5.0 and {check.part for check in grade.checks} == {"server"}
    assert not grade.all_right


def test_reason_why_the_server_ended_is_told_where_no_check_examines_that() -> None:
    lines = ("Traceback (most recent call last):", "NameError: name 'x' is not defined")
    start = replace(RIGHT, name="start", up=False, deaths=(rec.Death(0.1, 1),))
    start = replace(start, lines=tuple(rec.Line(0.1, line) for line in lines))
    reason = "server: The node ended while starting: NameError: name 'x' is not defined."
    assert judge("x", load(PLAN).restricted(["reaches_goal"]), {"server": {"start": start}}, {}).problems == (reason,)
    assert judge("x", load(PLAN), {"server": {"start": start}}, {}).problems == ()


def test_gradescope_gets_the_points_of_each_check_and_the_total() -> None:
    plan = load(PLAN)
    grade = _grade(plan, start=replace(RIGHT, name="start"), left=replace(RIGHT, name="left"))
    report = as_gradescope(grade, plan)
    tests = cast("list[dict[str, Any]]", report["tests"])
    assert report["score"] == pytest.approx(sum(test["score"] for test in tests))
    assert len(tests) == len(grade.checks)
    assert {test["status"] for test in tests if test["score"]} == {"passed"}
    assert sum(test["max_score"] for test in tests) == pytest.approx(grade.points_available)


def test_extra_check_that_failed_has_no_score_on_gradescope_and_is_no_failure_on_github() -> None:
    plan = load(PLAN)
    grade = judge("x", plan, {"bridge": {"frame": Record("frame", "bridge")}}, {})
    (extra,) = [check for check in grade.checks if check.extra]
    tests = cast("list[dict[str, Any]]", as_gradescope(grade, plan)["tests"])
    (shown,) = [test for test in tests if test["number"] == f"bridge.{extra.name}"]
    assert extra.outcome is not Outcome.PASSED and not {"score", "max_score", "status"}.intersection(shown)
    assert extra.name not in str(as_classroom(grade))


def test_topic_that_nobody_publishes_is_named_if_something_failed() -> None:
    own = ("/robovop_goto_as/goal", "/robovop_goto_as/cancel")
    waits = replace(
        RIGHT, name="start", servers=("/robovop_goto_as",), unpublished=("/ground_truth_odom", "/scn", *own)
    )
    problems = _grade(load(PLAN), start=waits).problems
    assert not any("robovop" in problem for problem in problems)
    assert any("subscribes to /scn, which nobody publishes" in problem for problem in problems)
    assert any("ground_truth_odom, which nobody publishes; the position comes from /odom" in it for it in problems)


def test_programs_of_ros_that_a_node_starts_are_named_whatever_failed() -> None:
    starts = replace(RIGHT, name="start", programs=("rostopic", "rosservice"))
    problems = _grade(load(PLAN), start=starts, again=replace(starts, name="left")).problems
    assert [it.startswith("server: it starts rosservice, rostopic: in a grading,") for it in problems] == [False, True]
