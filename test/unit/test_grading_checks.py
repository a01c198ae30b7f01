"""Each check on constructed records: a correct one passes, each mistake fails with its own cause."""

import dataclasses
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Tuple, cast

import pytest
import yaml
from support import ROOT

from aro_robocop_goto_as.errors import ParameterError, PlanError
from aro_robocop_goto_as.grading import record as rec
from aro_robocop_goto_as.grading.check_limits import Limits
from aro_robocop_goto_as.grading.checks import CHECKS, Failed, NotReached, Passed
from aro_robocop_goto_as.grading.gradescope import as_gradescope
from aro_robocop_goto_as.grading.judge import Outcome, judge
from aro_robocop_goto_as.grading.plan import Plan, load, world_of
from aro_robocop_goto_as.grading.record import Record

PLAN = Path(ROOT, "config", "grading.yaml")
LIMITS = Limits()
GOAL = rec.Goal("g", 1.0, 1.0, 0.0, "SUCCEEDED")


def _drive() -> Record:
    """A run: the robot turns by 45 degrees in 2 s, then drives to the goal in 8 s, with feedback at every tick."""
    samples: List[rec.Sample] = []
    commands, feedback = [], []
    far = math.hypot(1.0, 1.0) - 0.09
    for tick in range(131):
        t = tick / 10.0
        turn, way = min(1.0, t / 2.0), max(0.0, min(1.0, (t - 2.0) / 8.0))
        yaw, along = turn * math.pi / 4.0, way * far
        x, y = along * math.cos(math.pi / 4.0), along * math.sin(math.pi / 4.0)
        moving = 2.0 <= t < 10.0
        samples.append(
            rec.Sample(
                t,
                x,
                y,
                yaw,
                x + 40.0,
                y - 15.0,
                yaw + 0.7,
                far / 8.0 if moving else 0.0,
                math.pi / 8.0 if t < 2.0 else 0.0,
                math.inf,
                False,
            )
        )
        if t <= 10.0:
            commands.append(rec.Command(t, 0.16 if moving else 0.0, 0.39 if t < 2.0 else 0.0))
            error = rec.errors_at(samples[-1], GOAL)
            feedback.append(rec.Feedback(t, "g", error[0], error[1]))
    return Record(
        "left",
        "server",
        samples=tuple(samples),
        goals=(GOAL,),
        commands=tuple(commands),
        feedback=tuple(feedback),
        statuses=(rec.Status(0.0, "g", rec.ACTIVE), rec.Status(10.0, "g", rec.SUCCEEDED)),
        results=(rec.Result(10.0, "g", rec.SUCCEEDED, True, "there"),),
    )


RIGHT = _drive()


def _changed(**fields: Any) -> Record:
    return replace(RIGHT, **fields)


def _fed_back(position: Any = None, angle: Any = None) -> Record:
    """The same run with different values in its feedback."""
    return _changed(
        feedback=tuple(
            replace(
                it,
                position_error=position(it.position_error) if position else it.position_error,
                angle_error=angle(it.angle_error) if angle else it.angle_error,
            )
            for it in RIGHT.feedback
        )
    )


def _commanded(change: Any) -> Record:
    return _changed(commands=tuple(change(it) for it in RIGHT.commands))


@pytest.mark.parametrize(
    "name",
    [
        "feedback_rate",
        "feedback_position",
        "feedback_angle",
        "turns_to_goal",
        "drives_straight",
        "reaches_goal",
        "success_result",
        "stands_at_end",
        "one_ending",
        "no_exception",
        "stays_alive",
    ],
)
def test_correct_run_passes(name: str) -> None:
    assert CHECKS[name](RIGHT, LIMITS) == Passed()


WRONG: List[Tuple[str, Record, str]] = [
    ("feedback_rate", _changed(feedback=()), "No feedback was sent at all"),
    ("feedback_rate", _changed(feedback=RIGHT.feedback[::5]), "not sent in each iteration"),
    ("feedback_rate", _changed(feedback=RIGHT.feedback * 5), "not paced"),
    ("feedback_position", _fed_back(position=lambda _: 0.7), "always 0.70"),
    ("feedback_position", _fed_back(position=lambda _: 0.0), "never filled in"),
    ("feedback_position", _fed_back(position=lambda d: d * d), "squared"),
    ("feedback_position", _fed_back(position=lambda _: math.nan), "not finite"),
    ("feedback_angle", _fed_back(angle=lambda a: a - 2.0 * math.pi), "not wrapped: -5.5 rad"),
    ("feedback_angle", _fed_back(angle=math.degrees), "degrees"),
    ("feedback_angle", _fed_back(angle=lambda a: a + 1.0 if 0.5 < a < 0.65 else a), "angle_error is not the goal's"),
    ("feedback_angle", _fed_back(angle=lambda a: -a), "sign of angle_error is wrong"),
    ("turns_to_goal", _commanded(lambda c: replace(c, v=0.1)), "drives while it turns"),
    (
        "turns_to_goal",
        _commanded(lambda c: replace(c, v=0.1, w=c.w if c.time < 0.4 else 0.0)),
        "the threshold of angle_error is not 0.1 rad",
    ),
    ("turns_to_goal", _commanded(lambda c: replace(c, w=-c.w)), "turns away"),
    ("turns_to_goal", _commanded(lambda c: replace(c, w=0.0)), "angle_error is 0.79 rad but angular.z stayed 0"),
    ("turns_to_goal", _changed(commands=()), "nothing was published on /cmd_vel"),
    ("drives_straight", _commanded(lambda c: replace(c, v=-c.v)), "backward"),
    ("drives_straight", _commanded(lambda c: replace(c, v=0.0)), "does not drive"),
    ("drives_straight", _commanded(lambda c: replace(c, w=0.5)), "keeps turning"),
    ("reaches_goal", _changed(results=()), "no terminal state"),
    ("reaches_goal", _fed_back(position=lambda d: d - 0.1), "the threshold is another one"),
    ("reaches_goal", _changed(results=(rec.Result(5.0, "g", rec.SUCCEEDED, True, "there"),)), "threshold"),
    ("reaches_goal", _changed(results=(rec.Result(10.0, "g", rec.ABORTED, False, ""),)), "set_aborted is called"),
    ("success_result", _changed(results=(rec.Result(10.0, "g", rec.SUCCEEDED, False, ""),)), "result is missing"),
    ("success_result", _changed(results=(rec.Result(10.0, "g", rec.SUCCEEDED, True, ""),)), "empty"),
    ("stands_at_end", _changed(samples=tuple(replace(s, v=0.2) for s in RIGHT.samples)), "kept moving"),
    ("one_ending", _changed(results=RIGHT.results * 2), "two terminal states"),
    (
        "no_exception",
        _changed(lines=(rec.Line(3.0, "Traceback (most recent call last):"), rec.Line(3.0, "KeyError: 'x'"))),
        "KeyError: 'x'",
    ),
    ("stays_alive", _changed(deaths=(rec.Death(4.0, 1),)), "died"),
]


@pytest.mark.parametrize("name, record, words", WRONG, ids=lambda it: it if isinstance(it, str) else "")
def test_mistake_fails_its_check_with_the_cause(name: str, record: Record, words: str) -> None:
    verdict = CHECKS[name](record, LIMITS)
    assert isinstance(verdict, Failed), verdict
    assert words in verdict.cause


@pytest.mark.parametrize(
    "name", [name for name in CHECKS if name not in ("no_exception", "stays_alive", "bridge_alive", "waits_for_server")]
)
def test_empty_record_never_passes(name: str) -> None:
    assert not isinstance(CHECKS[name](Record("start", "server", up=False), LIMITS), Passed)


def test_a_misspelt_name_is_reported() -> None:
    record = Record("start", "server", up=False, servers=("/robovop_goto_as",), types=("x/GoToPositionAction",))
    verdict = CHECKS["action_server"](record, LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause == "The action server is called robovop_goto_as; the handout says robocop_goto_as"


def test_record_is_unchanged_by_writing_and_reading(tmp_path: Path) -> None:
    rec.write(RIGHT, tmp_path / "r.json")
    assert rec.read(tmp_path / "r.json") == RIGHT


@pytest.mark.parametrize("line", ["[INFO] on the way", "[INFO] [1668.1, 2.3]: on the way", "\x1b[32m[DEBUG] x"])
def test_information_is_never_a_cause(line: str) -> None:
    record = _changed(deaths=(rec.Death(4.0, 1),), lines=(rec.Line(3.0, line),))
    verdict = CHECKS["stays_alive"](record, LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause == "The node died: its output names no error"


def test_error_is_named_with_its_file_and_line() -> None:
    traceback = (
        "Traceback (most recent call last):",
        '  File "/home/anna/robocop_goto_as.py", line 34, in execute_cb',
        "    x, y = self.pose",
        "TypeError: cannot unpack non-iterable NoneType object",
        "[INFO] shutting down",
    )
    record = _changed(deaths=(rec.Death(4.0, 1),), lines=tuple(rec.Line(3.0, line) for line in traceback))
    verdict = CHECKS["stays_alive"](record, LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause == (
        "The node died: TypeError: cannot unpack non-iterable NoneType object "
        "(robocop_goto_as.py, line 34: x, y = self.pose)"
    )


def test_exception_in_a_library_is_given_the_place_in_the_node() -> None:
    traceback = (
        "Traceback (most recent call last):",
        '  File "/tmp/solution/robocop_goto_as.py", line 51, in execute_cb',
        "    position_error = np.linalg.norm(dx, dy)",
        '  File "<__array_function__ internals>", line 200, in norm',
        '  File "/usr/lib/python3/dist-packages/numpy/linalg/linalg.py", line 2592, in norm',
        '    raise ValueError("Improper number of dimensions to norm.")',
        "ValueError: Improper number of dimensions to norm.",
    )
    record = _changed(deaths=(rec.Death(4.0, 1),), lines=tuple(rec.Line(3.0, line) for line in traceback))
    verdict = CHECKS["stays_alive"](record, LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause.endswith("norm. (robocop_goto_as.py, line 51: position_error = np.linalg.norm(dx, dy))")


def test_server_that_never_succeeds_is_not_blamed_for_odd_ranges() -> None:
    stuck = _changed(goals=(GOAL,), results=(), problem="the robot made no progress for 8 s, and the goal did not end")
    records = {"server": {"left": stuck, "odd_scan": replace(stuck, name="odd_scan")}}
    checks = {check.name: check for check in judge("anna", load(PLAN), records, {}).checks}
    odd = checks["odd_scans"].failure
    assert odd is not None and odd.cause.startswith("This follows from another failed check") and "NaN" not in odd.cause


def test_exception_in_a_click_callback_is_named_as_the_cause_of_a_missing_goal() -> None:
    lines = ("bad callback: <goal_cb>", "Traceback (most recent call last):", "AttributeError: no attribute 'x'")
    click = rec.Click(1.0, "odom", 1.2, -0.4, 1.2, -0.4)
    record = _changed(goals=(), clicks=(click,), lines=tuple(rec.Line(2.0, line) for line in lines))
    record = replace(record, name="click", part="bridge")
    checks = {check.name: check for check in judge("anna", load(PLAN), {"bridge": {"click": record}}, {}).checks}
    crash = checks["bridge_alive"].failure
    assert crash is not None and "AttributeError: no attribute 'x'" in crash.cause
    assert checks["forwards_goal"].follows == "bridge_alive"
    assert "wait_for_server" not in checks["waits_for_server"].explanation()


def test_wall_that_was_hit_without_odd_ranges_is_not_blamed_on_them() -> None:
    goal = replace(GOAL, ends="ABORTED")
    hit = _changed(goals=(goal,))
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
    misled = replace(_fed_back(position=lambda d: d / 20.0), results=early)
    still_driving = {"stands_at_end": ""}
    assert _failures(misled) == {"feedback_position": "", "reaches_goal": "feedback_position", **still_driving}
    unrelated = replace(_fed_back(position=lambda _: 1.0), results=early)  # its feedback did not say that it was there
    assert _failures(unrelated) == {"feedback_position": "", "reaches_goal": "", **still_driving}


def test_robot_that_acts_on_its_wrong_angle_turns_wrongly_because_of_that() -> None:
    wrong = replace(_fed_back(angle=lambda a: -a), commands=_commanded(lambda c: replace(c, w=-c.w)).commands)
    assert _failures(wrong) == {"feedback_angle": "", "turns_to_goal": "feedback_angle"}
    assert _failures(_commanded(lambda c: replace(c, w=-c.w))) == {"turns_to_goal": ""}


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


def test_mistakes_are_sorted_by_the_points_that_they_and_what_follows_from_them_cost() -> None:
    wrong = replace(_fed_back(angle=lambda a: -a), commands=_commanded(lambda c: replace(c, w=-c.w)).commands)
    wrong = replace(wrong, samples=tuple(replace(sample, v=0.2) for sample in wrong.samples))
    mistakes = judge("anna", load(PLAN), {"server": {"left": wrong}}, {}).mistakes
    found = [(mistake.check.name, mistake.points, mistake.followers) for mistake in mistakes]
    assert found == [("feedback_angle", 0.7, 1), ("stands_at_end", 0.15, 0)]


def test_plan_has_five_server_points_three_bridge_points_and_a_function_for_each_check() -> None:
    plan = load(PLAN)
    points = {
        part: round(sum(check.points for check in plan.checks if check.part == part and not check.extra), 6)
        for part in ("server", "bridge")
    }
    assert points == {"server": 5.0, "bridge": 3.0}
    assert plan.points == 8.0
    assert {check.name for check in plan.checks} == set(CHECKS)
    known = {scenario.name for scenario in plan.scenarios} | {"start", "no_server", "click", "replace", "frame"}
    assert {name for check in plan.checks for name in check.scenarios} <= known
    assert len(world_of(plan).obstacles) == 1 + sum(len(scenario.obstacles) for scenario in plan.scenarios)


def test_the_plan_documents_every_limit_with_its_default_and_sets_none() -> None:
    section = PLAN.read_text().partition("limits:\n")[2].partition("\n\n")[0].splitlines()
    lines = [re.fullmatch(r"  #(\w+): (\S+) +# \S.*", line) for line in section]
    assert all(lines) and yaml.safe_load(PLAN.read_text())["limits"] is None
    assert {line[1]: float(line[2]) for line in lines if line} == dataclasses.asdict(LIMITS)
    assert load(PLAN).limits == LIMITS


@pytest.mark.parametrize(
    "old, new, error",
    [
        ("  #feedback_low: 7.0", "  feedback_lou: 7.0", "did you mean 'feedback_low'"),
        ("points: 0.5, scenarios: [start]", "punkte: 0.5, scenarios: [start]", "unknown: punkte"),
        ("goal: [0.5..0.9, 0.5..0.9]", "goal: [0.7]", "expected 2 numbers"),
        ("ends: ABORTED", "ends: FAILED", "expected SUCCEEDED, ABORTED or PREEMPTED"),
        ("limits:", "limits: [", "line"),
        ("limits:", "border:", "unknown: border"),
        ("  #stall: 8.0", "  stall: .nan", "stall: expected a finite number"),
        (
            "goal: [0.5..0.9, 0.5..0.9]",
            "goal: [.nan, 0.7]",
            "expected a number or a range LOW..HIGH from -20 to 20, got nan",
        ),
        ("goal: [0.5..0.9, 0.5..0.9]", "goal: [0.9..0.5, 0.7]", "left: goal: 0.9..0.5: expected LOW..HIGH"),
        (
            "goal: [0.5..0.9, 0.5..0.9]",
            "goal: [0.5..90, 0.7]",
            "expected a number or a range LOW..HIGH from -20 to 20, got",
        ),
        ("goal: [0.5..0.9, 0.5..0.9]", "goal: [0.5...9, 0.7]", "got '0.5...9'"),
        ("for: 2.5..3.5", "for: long", "for: expected a number or a range LOW..HIGH from 0"),
        (
            "points: 0.5, scenarios: [start]",
            "points: -1, scenarios: [start]",
            "points: expected a number from 0",
        ),
        ("points: 0.5, scenarios: [start]", "points: 0.3..0.5, scenarios: [start]", "points: expected a number from 0"),
        ("points: 0.5, scenarios: [start]", "points: 0.5, scenarios: start", "expected a list of names, got 'start'"),
        ("scenarios: [left, far]", "scenarios: [lefft, far]", "unknown for a server: 'lefft'"),
        (
            "part: bridge, points: 1.0, scenarios: [click]",
            "part: bridge, points: 1.0, scenarios: [left]",
            "unknown for a bridge: 'left'",
        ),
        ("  far_goal:", "  farr_goal:", "unknown: farr_goal"),
        ("name: right", "name: left", "left: expected a unique name"),
        ("name: right", "name: a/b", "expected letters, digits and _"),
        (
            "- {goal: [0.5..0.9, 0.5..0.9], ends: SUCCEEDED}",
            "- {cancel: true}",
            "cancel: expected an earlier goal in the script",
        ),
        ("- {goal: [0.5..0.9, 0.5..0.9], ends: SUCCEEDED}", "- {ends: SUCCEEDED}", "one of goal, cancel and place"),
        ("box: [0.9..1.5, 0.3, 0.29, 0.1, 2.4]", "box: [1.2, 0.0, 0.0, -0.1, 2.4]", "expected sizes above 0"),
    ],
)
def test_a_mistake_in_the_plan_is_refused(tmp_path: Path, old: str, new: str, error: str) -> None:
    text = PLAN.read_text()
    assert old in text
    (tmp_path / "plan.yaml").write_text(text.replace(old, new))
    with pytest.raises((PlanError, ParameterError), match=error):
        load(tmp_path / "plan.yaml")


def _grade(plan: Plan, **records: Record) -> Any:
    return judge("x", plan, {"server": records}, {"server": "time-out: it was at left"})


def test_interrupted_scenario_fails_its_checks_with_the_reason() -> None:
    checks = {check.name: check for check in _grade(load(PLAN), start=replace(RIGHT, name="start")).checks}
    assert checks["action_server"].outcome is Outcome.PASSED
    assert checks["reaches_goal"].outcome is Outcome.FAILED
    assert "time-out: it was at left" in checks["reaches_goal"].explanation()


def test_only_submitted_parts_are_graded() -> None:
    grade = judge("x", load(PLAN), {"server": {"start": replace(RIGHT, name="start")}}, {})
    assert grade.points_available == 5.0 and {check.part for check in grade.checks} == {"server"}
    assert not grade.all_right


def test_check_that_was_not_reached_states_the_reason() -> None:
    verdict = CHECKS["cancel"](RIGHT, LIMITS)
    assert verdict == NotReached("the goal ended before it could be cancelled")


def test_gradescope_gets_the_points_of_each_check_and_the_total() -> None:
    plan = load(PLAN)
    grade = _grade(plan, start=replace(RIGHT, name="start"), left=replace(RIGHT, name="left"))
    report = as_gradescope(grade, plan)
    tests = cast("list[dict[str, Any]]", report["tests"])
    assert report["score"] == pytest.approx(sum(test["score"] for test in tests))
    assert len(tests) == len(grade.checks)
    assert {test["status"] for test in tests if test["score"]} == {"passed"}
    assert sum(test["max_score"] for test in tests) == pytest.approx(grade.points_available)


def test_topic_that_nobody_publishes_is_named_if_something_failed() -> None:
    own = ("/robovop_goto_as/goal", "/robovop_goto_as/cancel")
    waits = replace(
        RIGHT, name="start", servers=("/robovop_goto_as",), unpublished=("/ground_truth_odom", "/scn", *own)
    )
    problems = _grade(load(PLAN), start=waits).problems
    assert not any("robovop" in problem for problem in problems)
    assert any("subscribes to /scn, which nobody publishes" in problem for problem in problems)
    assert any("ground_truth_odom, which nobody publishes; the position comes from /odom" in it for it in problems)
