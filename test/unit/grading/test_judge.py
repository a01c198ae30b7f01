"""Outcomes, points, and what follows from what."""

import math
from dataclasses import replace
from typing import Any, cast

import pytest
from grading_records import GOAL, PLAN, RIGHT, changed, commanded, fed_back, graded

from robocop_grading import record as rec
from robocop_grading.grades import CheckOutcome
from robocop_grading.judge import judge
from robocop_grading.plan import CheckPlan
from robocop_grading.record import Record
from robocop_grading.report.write import as_classroom, as_gradescope

SMALL = replace(
    PLAN,
    checks=(
        CheckPlan("action_server", 1.0),
        CheckPlan("feedback_angle", 1.5),
        CheckPlan("turns_to_goal", 2.0),
        CheckPlan("stands_at_end", 0.5),
        CheckPlan("forwards_goal", 4.0),
    ),
)
EARLY = (rec.Result(5.0, "g", rec.SUCCEEDED, True, "there"),)
START = replace(RIGHT, name="start")
CLICK = rec.Click(1.0, "odom", 1.2, -0.4, 1.2, -0.4)
MISLED = replace(fed_back(angle=lambda a: -a), commands=commanded(lambda c: replace(c, w=-c.w)).commands)


def lines(*texts):
    return tuple(rec.Line(0.1, text) for text in texts)


NO_NAME = lines("Traceback (most recent call last):", "NameError: name 'x' is not defined")


def checks_of(*records):
    return {check.name: check for check in graded(*records).checks}


def cause_of(check, *records):
    failure = checks_of(*records)[check].failure
    assert failure is not None
    return failure.cause


def failures(record):
    """The failed checks of a scenario, and what each follows from."""
    return {name: check.follows for name, check in checks_of(record).items() if check.failure is not None}


def test_server_that_never_succeeds_is_not_blamed_for_odd_ranges():
    stuck = changed(results=(), problem="the robot made no progress for 8 s, and the goal did not end")
    words = checks_of(stuck, replace(stuck, name="odd_scan"))["odd_scans"].words
    assert words.startswith("failed: This follows from another failed check") and "NaN" not in words


def test_exception_in_a_click_callback_is_named_as_the_cause_of_a_missing_goal():
    printed = lines(
        "[ERROR] bad callback: <goal_cb>", "Traceback (most recent call last):", "AttributeError: no attribute 'x'"
    )
    record = changed(name="click", part="bridge", goals=(), clicks=(CLICK,), lines=printed)
    assert "AttributeError: no attribute 'x'" in cause_of("bridge_alive", record)
    checks = checks_of(record)
    assert checks["forwards_goal"].follows == "bridge_alive"
    assert "wait_for_server" not in checks["waits_for_server"].words


def test_wall_that_was_hit_without_odd_ranges_is_not_blamed_on_them():
    hit = changed(name="odd_scan_wall", goals=(replace(GOAL, ends="ABORTED"),))
    checks = checks_of(replace(hit, name="obstacle"), hit)
    assert checks["stops_at_obstacle"].failure is not None
    assert checks["odd_scans"].follows == "stops_at_obstacle"
    assert 'This follows from another failed check: "An obstacle closer than' in checks["odd_scans"].words
    assert "NaN hides the wall" in cause_of("odd_scans", hit)


def test_what_a_wrong_error_leads_to_follows_from_it_and_another_mistake_does_not():
    def ended_early(record):
        return replace(record, results=EARLY, feedback=record.feedback[:51])

    misled = ended_early(fed_back(position=lambda d: d / 20.0))
    still_driving = {"stands_at_end": ""}
    assert failures(misled) == {"feedback_position": "", "reaches_goal": "feedback_position", **still_driving}
    unrelated = ended_early(fed_back(position=lambda _: 1.0))  # its feedback did not say that it was there
    assert failures(unrelated) == {"feedback_position": "", "reaches_goal": "", **still_driving}


def test_robot_that_acts_on_its_wrong_angle_turns_wrongly_because_of_that():
    assert failures(MISLED) == {"feedback_angle": "", "turns_to_goal": "feedback_angle"}
    assert failures(replace(RIGHT, commands=MISLED.commands)) == {"turns_to_goal": ""}
    partly = commanded(lambda c: replace(c, w=-c.w, v=c.v if c.time < 6.0 else 0.0)).commands
    own = {"feedback_angle": "", "turns_to_goal": "", "drives_straight": ""}
    assert failures(replace(MISLED, commands=partly)) == own, "of its commands 40 % do not fit its angle"


def test_cause_of_wrong_feedback_fits_in_all_scenarios():
    shorter = cause_of("feedback_position", fed_back(position=lambda d: d / math.sqrt(2.0)))
    assert shorter.count("; or: ") == 1 and all(word in shorter for word in ("is |dx|", "is |dy|"))
    both = cause_of("feedback_position", fed_back(position=lambda _: 1.0), replace(RIGHT, name="right"))
    assert "position_error is 1.00 m where it has to be 1.41 m, the distance" in both


def test_pose_that_never_changes_is_explained_by_the_topic_that_nobody_publishes():
    unturned = []
    for name, goal in (("left", GOAL), ("right", replace(GOAL, x=-1.0))):
        errors = [goal.errors_at(replace(at, yaw=0.0)) for at in RIGHT.samples]
        told = [replace(it, position_error=d, angle_error=a) for it, (d, a) in zip(RIGHT.feedback, errors)]
        unturned.append(changed(name=name, goals=(goal,), feedback=tuple(told)))
    assert "as if the heading stayed 0" in cause_of("feedback_angle", *unturned)
    start = Record("start", "server", unpublished=("/odometry/filtered", "/laser"))
    assert "subscribes to /odometry/filtered" in cause_of("feedback_angle", start, *unturned)


def test_node_that_ends_while_starting_has_made_one_mistake_and_the_other_part_has_its_own():
    dead = Record("start", "server", up=False, lines=NO_NAME, node_ends=(rec.NodeEnd(0.2, 1),))
    bridge = replace(dead, name="no_server", part="bridge")
    grade = judge("anna", PLAN, {"server": {"start": dead}, "bridge": {"no_server": bridge}}, {})
    assert sorted(mistake.check.name for mistake in grade.mistakes) == ["action_server", "waits_for_server"]


def test_mistake_that_blocks_most_points_comes_first():
    """As of the empty skeleton."""
    records = {
        "server": {"start": Record("start", "server", up=False)},
        "bridge": {"click": Record("click", "bridge", clicks=(CLICK,), marks={"clients": 0.0})},
    }
    first, second = judge("anna", SMALL, records, {}).mistakes
    assert (first.check.name, first.points, len(first.followers)) == ("action_server", 5.0, 3)
    assert (second.check.name, second.points) == ("forwards_goal", 4.0)


def test_mistakes_are_sorted_by_the_points_that_they_and_what_follows_from_them_cost():
    wrong = replace(MISLED, samples=tuple(replace(sample, v=0.2) for sample in MISLED.samples))
    found = [
        (mistake.check.name, mistake.points, len(mistake.followers))
        for mistake in judge("anna", SMALL, {"server": {"left": wrong}}, {}).mistakes
    ]
    assert found == [("feedback_angle", 3.5, 1), ("stands_at_end", 0.5, 0)]


def test_check_that_passed_names_the_first_scenario_that_it_examined():
    check = checks_of(RIGHT, replace(RIGHT, name="right"))["reaches_goal"]
    assert (check.outcome, check.scenario) == (CheckOutcome.PASSED, "left")


def test_interrupted_scenario_fails_its_checks_with_the_reason_and_the_other_part_is_not_graded():
    grade = judge("anna", SMALL, {"server": {"start": START}}, {"server": "time-out: it was at left"})
    outcomes = {check.name: check.outcome for check in grade.checks}
    assert (outcomes["action_server"], outcomes["turns_to_goal"]) == (CheckOutcome.PASSED, CheckOutcome.FAILED)
    assert all("time-out: it was at left" in check.words for check in grade.checks if check.failure is not None)
    assert (
        grade.points_available == 5.0
        and len(grade.mistakes) == 1
        and {check.part for check in grade.checks} == {"server"}
    )
    assert not grade.all_right


def test_reason_why_the_server_ended_is_told_where_no_check_examines_that():
    start = replace(START, up=False, node_ends=(rec.NodeEnd(0.1, 1),), lines=NO_NAME)
    reason = "server: The node ended while starting: NameError: name 'x' is not defined."
    assert judge("x", PLAN.restricted(["reaches_goal"]), {"server": {"start": start}}, {}).problems == (reason,)
    assert graded(start).problems == ()


def test_gradescope_gets_the_points_of_each_check_and_the_total():
    grade = graded(START, RIGHT, problem="time-out")
    report = as_gradescope(grade)
    tests = cast("list[dict[str, Any]]", report["tests"])
    assert report["score"] == pytest.approx(sum(test["score"] for test in tests))
    assert len(tests) == len(grade.checks)
    assert {test["status"] for test in tests if test["score"]} == {"passed"}
    assert sum(test["max_score"] for test in tests) == pytest.approx(grade.points_available)


def test_extra_check_that_failed_has_no_score_on_gradescope_and_is_no_failure_on_github():
    grade = graded(Record("frame", "bridge"))
    (extra,) = [check for check in grade.checks if check.extra]
    tests = cast("list[dict[str, Any]]", as_gradescope(grade)["tests"])
    (shown,) = [test for test in tests if test["number"] == f"bridge.{extra.name}"]
    assert extra.outcome is not CheckOutcome.PASSED and not {"score", "max_score", "status"}.intersection(shown)
    assert extra.name not in str(as_classroom(grade))


def test_topic_that_nobody_publishes_is_named_if_something_failed():
    own = ("/robovop_goto_as/goal", "/robovop_goto_as/cancel")
    waits = replace(START, servers=("/robovop_goto_as",), unpublished=("/ground_truth_odom", "/scn", *own))
    notes = graded(waits, problem="time-out").notes
    assert not any("robovop" in note for note in notes)
    assert any("subscribes to /scn, which nobody publishes" in note for note in notes)
    assert any("ground_truth_odom, which nobody publishes; the position comes from /odom" in it for it in notes)


def test_programs_of_ros_that_a_node_starts_are_named_whatever_failed():
    starts = replace(START, programs=("rostopic", "rosservice"))
    notes = graded(starts, replace(starts, name="left")).notes
    assert [it.startswith("server: it starts rosservice, rostopic: in a grading,") for it in notes] == [True]


def test_goal_that_a_server_never_accepted_is_one_mistake():
    refused = "[ERROR] To transition to a succeeded state, the goal must be in a preempting or active state, it is "
    record = changed(lines=lines(f"{refused}currently in state: 0"), results=(), statuses=(), problem="no progress")
    assert failures(record) == {"one_ending": "", "reaches_goal": "one_ending"}


def test_newer_goal_that_is_not_served_follows_from_the_exception_that_ended_the_node():
    newer = replace(GOAL, id="h", time=4.0)
    dead = (rec.NodeEnd(4.1, 1),)
    printed = tuple(replace(it, time=4.1) for it in NO_NAME)
    record = changed(name="newer_goal", goals=(GOAL, newer), results=(), statuses=(), lines=printed, node_ends=dead)
    assert failures(record) == {"newer_goal": "no_exception", "no_exception": "", "stays_alive": "no_exception"}


def test_wrong_feedback_about_a_goal_that_ends_at_once_follows_from_what_an_earlier_goal_has_left():
    later = rec.SentGoal("h", -1.0, 0.0, 11.0, "SUCCEEDED")
    results = (*RIGHT.results, rec.Result(11.1, "h", rec.SUCCEEDED, True, "there"))
    kept = rec.Feedback(11.0, "h", 0.09, 0.0)
    record = changed(name="behind", goals=(GOAL, later), results=results, feedback=(*RIGHT.feedback[::20], kept))
    found = failures(record)
    assert (found["next_goal"], found["feedback_position"], found["feedback_angle"]) == ("", "next_goal", "next_goal")


def test_missing_feedback_follows_from_the_exception_that_ended_its_timer():
    printed = lines("Exception in thread Thread-6:", NO_NAME[0].text, "TypeError: tell() takes 1 argument")
    assert failures(changed(lines=printed, feedback=())) == {"no_exception": "", "feedback_rate": "no_exception"}
