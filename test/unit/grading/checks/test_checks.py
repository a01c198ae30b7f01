"""Each check on constructed records: a correct one passes, each mistake fails with its own cause."""

import math
from dataclasses import replace

import pytest
from grading_records import LIMITS, RIGHT, changed, commanded, fed_back

from robocop_grading import record as rec
from robocop_grading.checks import CHECKS, PASSED, Failed, NotReached
from robocop_grading.record import Record


@pytest.mark.parametrize("name", [name for name, check in CHECKS.items() if RIGHT.name in check.scenarios])
def test_correct_run_passes(name):
    assert CHECKS[name](RIGHT, LIMITS) is PASSED


_BEFORE = list(zip(RIGHT.feedback[:1] + RIGHT.feedback, RIGHT.feedback))
OLD = changed(feedback=tuple(replace(old, time=it.time) for old, it in _BEFORE))
OLD_ANGLE = changed(feedback=tuple(replace(it, angle_error=old.angle_error) for old, it in _BEFORE))
LATE = changed(results=(replace(RIGHT.results[0], time=12.0),), statuses=RIGHT.statuses[:1])
ERROR, WARN = "[ERROR] [1668.1, 2.3]: ", "\x1b[33m[WARN] [1668.1, 2.3]: "
TWO = "To transition to an aborted state, the goal must be in a preempting or active state, it is currently in state: 3"
NONE = (
    "Your executeCallback did not set the goal to a terminal status.  This is a bug in your ActionServer "
    "implementation. Fix your code!  For now, the ActionServer will set this goal to aborted"
)


def logged(*lines, **fields):
    """A right run that has printed these lines."""
    return changed(lines=tuple(rec.Line(3.0, line) for line in lines), **fields)


def _aborted(**changes):
    """A goal that is aborted 0.3 m before an obstacle, at 10 s."""
    goal, result = replace(RIGHT.goals[0], ends="ABORTED"), rec.Result(10.0, "g", rec.ABORTED, False, "obstacle")
    samples = tuple(replace(it, ahead=max(0.3, 1.3 - it.time / 10.0)) for it in RIGHT.samples)
    return changed(**{"goals": (goal,), "results": (result,), "samples": samples, **changes})


def _stuck(**fields):
    """A goal that does not end."""
    return changed(**{"results": (), "problem": "no progress for 8 s", **fields})


def commanded_before(command):
    """A right run in which this command came before all others."""
    return changed(commands=(command, *RIGHT.commands))


FOR_EVER = tuple(replace(RIGHT.feedback[-1], time=10.5 + tick / 10.0) for tick in range(8))
THERE = (replace(RIGHT.goals[0], x=-0.03, y=0.03),)
SUCCEEDED = (rec.Result(10.0, "g", rec.SUCCEEDED, True, "there"),)
HIT = tuple(replace(it, touching=it.time > 9.0) for it in RIGHT.samples)


def _cancelled(status, success):
    """A goal that ends 0.2 s after a cancel request."""
    return changed(cancels=(rec.Cancel(5.0, "g"),), results=(rec.Result(5.2, "g", status, success, "x"),))


WRONG = [
    ("feedback_rate", changed(feedback=()), "No feedback was sent at all"),
    ("feedback_rate", changed(feedback=RIGHT.feedback[::5]), "not sent in each iteration"),
    ("feedback_rate", changed(feedback=RIGHT.feedback * 5), "more often than 10 times"),
    ("feedback_rate", changed(feedback=(*RIGHT.feedback, *FOR_EVER)), "goes on after its result"),
    ("only_ahead_counts", changed(results=(replace(RIGHT.results[0], time=6.0),)), "before position_error is below"),
    ("already_there", changed(goals=THERE, results=(rec.Result(1.0, "g", rec.SUCCEEDED, True, ""),)), "turns at the"),
    ("feedback_position", fed_back(position=lambda _: 0.7), "always 0.70"),
    ("feedback_position", fed_back(position=lambda _: 0.0), "always zero"),
    ("feedback_position", fed_back(position=lambda _: math.nan), "not finite"),
    (
        "feedback_angle",
        fed_back(angle=lambda a: a + 1.0 if 0.5 < a < 0.65 else a),
        "angle_error is 1.63 rad where it has to be 0.63 rad",
    ),
    ("turns_to_goal", commanded(lambda c: replace(c, v=0.1)), "drives while it turns"),
    (
        "turns_to_goal",
        commanded(lambda c: replace(c, v=0.1, w=c.w if c.time < 0.4 else 0.0)),
        "drives straight, with linear.x 0.10, at an angle_error of 0.59 rad: beyond 0.1 rad it has to turn first",
    ),
    ("turns_to_goal", commanded(lambda c: replace(c, w=-c.w)), "turns away"),
    ("turns_to_goal", commanded(lambda c: replace(c, w=0.0)), "does not turn although angle_error is"),
    ("drives_straight", commanded(lambda c: replace(c, v=-c.v)), "backward"),
    ("drives_straight", commanded(lambda c: replace(c, v=0.0)), "does not drive"),
    ("drives_straight", commanded(lambda c: replace(c, v=c.v if c.time < 4.0 else 0.0)), "does not drive"),
    ("drives_straight", commanded(lambda c: replace(c, w=0.5)), "keeps turning"),
    ("reaches_goal", changed(results=()), "no terminal state"),
    ("reaches_goal", _stuck(commands=()), "for 8 s. Nothing was published on /cmd_vel"),
    ("reaches_goal", _stuck(commands=(rec.Command(1.0, 0.0, 0.5),)), "for 8 s. linear.x on /cmd_vel was never above 0"),
    ("reaches_goal", _stuck(unpublished=("/odometry",)), "for 8 s. The node subscribes to /odometry, which nobody"),
    ("stands_at_end", commanded_before(rec.Command(-0.5, 0.0, 0.5)), "to move although no goal is active"),
    ("stands_at_end", replace(commanded_before(rec.Command(0.1, 0.2, 0.0)), goals=(), results=()), "no goal is active"),
    ("feedback_position", fed_back(position=lambda d: d - 0.1), "position_error is 1.31 m where it has to be 1.41 m"),
    (
        "feedback_position",
        fed_back(position=lambda d: 100.0 * d),
        "position_error is 141.42 m where it has to be 1.41 m",
    ),
    ("feedback_angle", fed_back(angle=lambda a: a / 2.0), "angle_error is 0.39 rad where it has to be 0.79 rad"),
    ("feedback_angle", fed_back(angle=lambda a: a + 0.4), "angle_error is 1.19 rad where it has to be 0.79 rad"),
    ("feedback_position", OLD, "The feedback is old"),
    ("feedback_angle", OLD_ANGLE, "The feedback is old"),
    ("turns_to_goal", commanded(lambda c: replace(c, w=c.w if c.time > 1.3 else 0.0)), "does not turn although"),
    ("reaches_goal", LATE, "stands at the goal, but the result comes later"),
    ("reaches_goal", changed(results=(rec.Result(5.0, "g", rec.SUCCEEDED, True, "there"),)), "threshold"),
    ("reaches_goal", changed(results=(rec.Result(10.0, "g", rec.ABORTED, False, ""),)), "set_aborted is called"),
    (
        "success_result",
        changed(results=(rec.Result(10.0, "g", rec.SUCCEEDED, False, ""),)),
        "No result or an empty one",
    ),
    ("success_result", changed(results=(rec.Result(10.0, "g", rec.SUCCEEDED, True, ""),)), "empty"),
    ("success_result", changed(results=(rec.Result(10.0, "g", rec.SUCCEEDED, False, "there"),)), "contradicts the"),
    ("cancel", _cancelled(rec.ABORTED, False), "Call set_preempted for a goal that is cancelled"),
    ("cancel", _cancelled(rec.PREEMPTED, True), "result.success is true although the goal was not reached"),
    ("stops_at_obstacle", _aborted(results=SUCCEEDED), "set_succeeded is called although the goal failed"),
    ("stops_at_obstacle", _aborted(results=SUCCEEDED, samples=HIT), "obstacle ahead was nearer than 0.3 m"),
    (
        "stops_at_obstacle",
        _aborted(results=SUCCEEDED, samples=HIT, other_types=(("/scan", "a/PointCloud2", "a/LaserScan"),)),
        "/scan is used with the wrong type, a/PointCloud2; its type is a/LaserScan",
    ),
    (
        "stops_at_obstacle",
        _aborted(results=SUCCEEDED, samples=HIT, unpublished=("/odometry", "/laser")),
        "The node subscribes to /laser, which nobody publishes; the laser's topic is /scan",
    ),
    ("stands_at_end", changed(samples=tuple(replace(s, v=0.2) for s in RIGHT.samples)), "kept moving"),
    ("one_ending", changed(results=RIGHT.results * 2), "two terminal states"),
    ("one_ending", logged(ERROR + TWO), "two terminal states"),
    ("one_ending", logged(f"[ERROR] {TWO}"), "two terminal states"),
    (
        "one_ending",
        logged(f"[ERROR] {TWO[:-1]}0"),
        "A goal that was PENDING got a terminal state: it has to be accepted",
    ),
    ("one_ending", logged(WARN + NONE, statuses=(rec.Status(3.0, "g", rec.ABORTED),)), "returned without calling"),
    (
        "action_server",
        Record("start", "server", up=False, servers=("/robovop_goto_as",), types=("x/GoToPositionAction",)),
        "The action server is called robovop_goto_as; the handout says robocop_goto_as",
    ),
    ("action_server", Record("start", "server", servers=("/robovop_goto_as",)), "called robovop_goto_as; the"),
    (
        "action_server",
        Record("start", "server", up=False, servers=("/robocop_goto_as",), types=("actionlib/TestAction",)),
        "The action's type is actionlib/TestAction; the handout's is GoToPositionAction",
    ),
    (
        "stops_at_obstacle",
        _aborted(samples=tuple(replace(it, touching=it.time > 10.5) for it in _aborted().samples)),
        "kept moving after the result (ABORTED)",
    ),
    (
        "stops_at_obstacle",
        _aborted(
            samples=tuple(replace(it, touching=it.time > 10.5) for it in _aborted().samples),
            commands=(*RIGHT.commands, rec.Command(10.4, 0.2, 0.0)),
        ),
        "still commanded to move after the result",
    ),
]


@pytest.mark.parametrize("name, record, words", WRONG, ids=lambda it: it if isinstance(it, str) else "")
def test_mistake_fails_its_check_with_the_cause(name, record, words):
    verdict, explain = CHECKS[name](record, LIMITS), CHECKS[name].explain
    assert isinstance(verdict, Failed), verdict
    assert words in (explain({"left": record}, ["left"], verdict) if explain else verdict).cause


@pytest.mark.parametrize("name", CHECKS)
def test_empty_record_passes_only_the_checks_of_exceptions_and_deaths_and_fails_only_those_of_what_is_missing(name):
    kinds = {"action_server": Failed, "waits_for_server": Failed}
    kinds.update(dict.fromkeys(("no_exception", "stays_alive", "bridge_alive"), type(PASSED)))
    verdict = CHECKS[name](Record("start", "server", up=False), LIMITS)
    assert type(verdict) is kinds.get(name, NotReached), verdict


KEY_ERROR = "Traceback (most recent call last):", "KeyError: 'x'"
EXECUTE = "[ERROR] Exception in your execute callback: 'x'"
UNPACK = (
    "Traceback (most recent call last):",
    '  File "/home/anna/robocop_goto_as.py", line 34, in execute_cb',
    "    x, y = self.pose",
    "TypeError: cannot unpack non-iterable NoneType object",
    "[INFO] shutting down",
)
NORM = (
    "Traceback (most recent call last):",
    '  File "/tmp/solution/robocop_goto_as.py", line 51, in execute_cb',
    "    position_error = np.linalg.norm(dx, dy)",
    '  File "<__array_function__ internals>", line 200, in norm',
    '  File "/usr/lib/python3/dist-packages/numpy/linalg/linalg.py", line 2592, in norm',
    '    raise ValueError("Improper number of dimensions to norm.")',
    "ValueError: Improper number of dimensions to norm.",
)


@pytest.mark.parametrize(
    "lines, reason",
    [
        (["[INFO] on the way"], "its output names no error"),
        (["[INFO] [1668.1, 2.3]: on the way"], "its output names no error"),
        (["\x1b[32m[DEBUG] x"], "its output names no error"),
        (['message: "there"'], 'it had printed: message: "there"'),
        (["[FATAL] no scan"], "[FATAL] no scan"),
        (
            UNPACK,
            "TypeError: cannot unpack non-iterable NoneType object (robocop_goto_as.py, line 34: x, y = self.pose)",
        ),
        (NORM, f"{NORM[-1]} (robocop_goto_as.py, line 51: position_error = np.linalg.norm(dx, dy))"),
    ],
)
def test_reason_of_an_end_is_an_exception_with_its_place_in_the_node_or_a_line_that_is_no_information(lines, reason):
    status = int(len(lines) > 1)
    verdict = CHECKS["stays_alive"](logged(*lines, node_ends=(rec.NodeEnd(4.0, status),)), LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause == f"{'The node died' if status else 'The node ended by itself'}: {reason}"


STOP = (
    "[ERROR] bad callback: <function moved>\nTraceback (most recent call last):\n"
    '  File "/tmp/robocop_goto_as.py", line 5, in moved\n    raise Stop(1)\n__main__.Stop: 1'
)
NO_UTF8 = "SyntaxError: Non-UTF-8 code starting with '\\xf8' in file {}robocop_goto_as.py on line 3, but no"


@pytest.mark.parametrize(
    "lines, seen, place",
    [
        (("Exception in thread Thread-6:", *KEY_ERROR), "KeyError: 'x'", ""),
        ((STOP, "[WARN] on"), "__main__.Stop: 1", " (robocop_goto_as.py, line 5: raise Stop(1))"),
        ((NO_UTF8.format("/tmp/a b/"),), NO_UTF8.format(""), ""),
    ],
)
def test_exception_is_named_with_its_file_and_line_and_without_its_folder(lines, seen, place):
    verdict = CHECKS["no_exception"](logged(*lines), LIMITS)
    assert isinstance(verdict, Failed) and (verdict.seen, verdict.cause) == (seen, f"{seen}{place}")


def test_robot_may_stand_still_before_it_drives_and_be_told_so_before_the_first_goal():
    pause = commanded(lambda c: replace(c, v=0.0 if c.time < 4.0 else c.v))
    assert CHECKS["drives_straight"](pause, LIMITS) is PASSED
    assert CHECKS["stands_at_end"](commanded_before(rec.Command(-0.5, 0.0, 0.0)), LIMITS) is PASSED


@pytest.mark.parametrize(
    "line",
    [
        "[INFO] controller is currently in state ROTATING",
        "[INFO] [1668.1, 2.3]: a terminal state was reached",
        "[WARN] No terminal is attached",
        f"[INFO] {TWO}",
        "[INFO] no Traceback (most recent call last): here",
        "user should have patience",
    ],
)
def test_harmless_line_fails_no_check(line):
    record = logged(line)
    assert CHECKS["one_ending"](record, LIMITS) is PASSED
    assert CHECKS["no_exception"](record, LIMITS) is PASSED


def test_old_feedback_is_one_mistake_and_a_wrong_one_does_not_say_when_the_goal_is_reached():
    assert CHECKS["feedback_angle"](OLD, LIMITS) is PASSED
    assert CHECKS["reaches_goal"](fed_back(position=lambda d: d - 0.1), LIMITS) is PASSED


def test_cancel_that_is_noticed_late_is_not_one_that_is_never_noticed():
    cancelled = changed(cancels=(rec.Cancel(5.0, "g"),))
    late = replace(cancelled, results=(rec.Result(8.0, "g", rec.PREEMPTED, False, "x"),))
    verdict = CHECKS["cancel"](late, LIMITS)
    assert isinstance(verdict, Failed) and "noticed only 3.0 s later" in verdict.cause
    never = CHECKS["cancel"](cancelled, LIMITS)
    assert isinstance(never, Failed) and "is not noticed" in never.cause


def test_result_of_a_robot_that_rests_at_the_goal_may_come_a_second_later():
    later = changed(results=(replace(RIGHT.results[0], time=10.8),), statuses=RIGHT.statuses[:1])
    assert CHECKS["reaches_goal"](later, LIMITS) is PASSED


def test_robot_that_goes_on_at_the_goal_is_asked_for_its_threshold():
    drives = tuple(replace(it, v=0.2, x=it.x * 1.05, y=it.y * 1.05) for it in RIGHT.samples)
    late = changed(results=(replace(RIGHT.results[0], time=12.0),), statuses=RIGHT.statuses[:1], samples=drives)
    verdict = CHECKS["reaches_goal"](late, LIMITS)
    assert isinstance(verdict, Failed) and "compared with this threshold" in verdict.cause


@pytest.mark.parametrize(
    "time, line, words",
    [
        (9.9, EXECUTE, "KeyError"),
        pytest.param(11.0, EXECUTE, "", id="after the goal"),
        pytest.param(9.9, "Exception in thread Thread-6:", "", id="elsewhere"),
    ],
)
def test_only_an_exception_that_ends_a_goal_is_charged_to_it(time, line, words):
    lines = tuple(rec.Line(time, text) for text in (line, *KEY_ERROR))
    verdict = CHECKS["stops_at_obstacle"](_aborted(lines=lines), LIMITS)
    assert verdict is PASSED if not words else isinstance(verdict, Failed) and words in verdict.cause


@pytest.mark.parametrize("line", [KEY_ERROR[0], f"[ERROR] [1.2, 3.4]: {KEY_ERROR[0]}"])
def test_exception_that_the_node_has_caught_and_printed_fails_no_check_unless_the_node_dies_of_it(line):
    caught = logged(line, KEY_ERROR[1])
    assert CHECKS["no_exception"](caught, LIMITS) is PASSED
    assert CHECKS["stops_at_obstacle"](_aborted(lines=caught.lines), LIMITS) is PASSED
    assert isinstance(CHECKS["no_exception"](replace(caught, node_ends=(rec.NodeEnd(3.1, 1),)), LIMITS), Failed)


@pytest.mark.parametrize("end, is_at_once", [(0.1, True), (9.0, False)])
def test_preempted_goal_that_nobody_cancelled_is_called_so(end, is_at_once):
    verdict = CHECKS["reaches_goal"](changed(results=(rec.Result(end, "g", rec.PREEMPTED, False, "x"),)), LIMITS)
    assert isinstance(verdict, Failed) and "neither a cancel request" in verdict.cause
    assert ("with its parentheses" in verdict.cause) is is_at_once
