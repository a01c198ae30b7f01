"""The bridge's checks on constructed records."""

import math
from dataclasses import replace

import pytest
from grading_records import LIMITS

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse
from robocop_grading import record as rec
from robocop_grading.checks import CHECKS, PASSED, Failed
from robocop_grading.record import Record

SAME_WORDS = "do not tell a goal that is active from one that has succeeded, was aborted or was preempted"
BEFORE, NEWER = rec.Click(1.0, "odom", 1.2, -0.4, 1.2, -0.4), rec.Click(5.0, "odom", -0.6, 0.9, -0.6, 0.9)


def _clicked(x, y, *lines, servers=()):
    """A click becomes a goal at (x, y), which is ACTIVE at once, and SUCCEEDED after 20 s."""
    return Record(
        "click",
        "bridge",
        servers=servers,
        goals=(rec.SentGoal("g", x, y, 0.0, ""),),
        clicks=(rec.Click(0.0, "odom", 1.2, -0.4, 1.2, -0.4),),
        statuses=tuple(rec.Status(time, "g", state) for time, state in ((0, 0), (0, rec.ACTIVE), (20, rec.SUCCEEDED))),
        lines=tuple(rec.Line(time, text) for time, text in lines),
        marks={"watching": 0.0, "watched": 20.0},
    )


def _reported(active, succeeded):
    return _clicked(1.2, -0.4, *((float(t), active if t < 20 else succeeded) for t in range(2, 40, 4)))


@pytest.mark.parametrize(
    "active, succeeded",
    [
        ("[INFO] state: ACTIVE", "[INFO] state: SUCCEEDED"),
        ("state 1", "state 3"),
        ("the goal is active: ACTIVE", "the goal is done: SUCCEEDED"),
        ("published on /status: 1", "published on /status: 0"),  # numbers of its own
        ("state 2", "state 7"),  # of actionlib's CommState
        ("state 2", "state 4"),  # numbers of its own
        ("[INFO] ACTIVE: True", "[INFO] ACTIVE: False"),
        ("Stav akce: 1 (0 PENDING, 1 ACTIVE, 3 SUCCEEDED)", "Stav akce: 3 (0 PENDING, 1 ACTIVE, 3 SUCCEEDED)"),
        ("PENDING, ACTIVE, SUCCEEDED? jede", "PENDING, ACTIVE, SUCCEEDED? hotovo"),
        ("ACTIVE", "DONE"),
        ("state: ACTIVE", "state: LOST"),  # get_state() after stop_tracking_goal()
        ("all is well", "all is well"),
        ("report 3", "report 4"),
        ("connected: True, result: None", "connected: True, result: there"),
        ("[INFO] [1668.1, 2.3]: no errors", "no errors"),
        ("state: ACTIVE (previous: PENDING)", "state: SUCCEEDED (previous: ACTIVE)"),
        ("goal state 1 (0 PENDING, 1 ACTIVE, 3 SUCCEEDED)", "goal state 3 (0 PENDING, 1 ACTIVE, 3 SUCCEEDED)"),
    ],
)
def test_true_reports_and_those_in_other_words_pass(active, succeeded):
    assert CHECKS["reports_status"](_reported(active, succeeded), LIMITS) is PASSED


@pytest.mark.parametrize(
    "active, succeeded, words",
    [
        ("ACTIVE", "ACTIVE", "reports ACTIVE while the newest goal is SUCCEEDED"),
        ("active", "active", SAME_WORDS),
        ("published on /status: 1", "published on /status: 1", SAME_WORDS),
        ("PENDING", "PENDING", "reports PENDING while the newest goal is ACTIVE"),
        ("ACTIVE", "ABORTED", "reports ABORTED while the newest goal is SUCCEEDED"),
        ("PREEMPTED", "ABORTED", "reports PREEMPTED while the newest goal is ACTIVE"),
        ("PENDING or ACTIVE or SUCCEEDED", "PENDING or ACTIVE or SUCCEEDED", SAME_WORDS),
        ("", "", 'say nothing about the state, as in ""'),
        ("[INFO] [1668.1, 2.3]: server:", "[INFO] server: done", 'as in "server:"'),
        ("\x1b[32m[INFO] status = None.", "SUCCEEDED", 'as in "status = None."'),
        ("published on /status: None", "published on /status: SUCCEEDED", 'as in "None"'),
        ("state None", "state None", 'as in "state None"'),
        ("server: <bound method A.get_state of <a.A object at 0x7f>>", "x", 'as in "server: <bound method'),
    ],
)
def test_reports_that_are_empty_or_untrue_are_named(active, succeeded, words):
    verdict = CHECKS["reports_status"](_reported(active, succeeded), LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


# Four goals, like those of the grader's scenario: when each is sent, for how long it is active [s], and how it ends.
DRIVES = (
    (1.0, 25.0, rec.SUCCEEDED),
    (32.0, 5.0, rec.ABORTED),
    (46.0, 2.0, rec.PREEMPTED),
    (48.4, 5.0, rec.PREEMPTED),
)
KEPT = 5.0  # [s] for which an ended goal stays in an action server's status


def _states(time, kept=math.inf):
    """The states of all goals at a time, the newest goal's last; without those that ended `kept` [s] before."""
    return [
        rec.ACTIVE if time < sent + active else end
        for sent, active, end in DRIVES
        if sent <= time < sent + active + kept
    ]


def _named(states):
    return [f"state: {rec.STATUS_NAMES[state]}" for state in states]


def _by_the_clock(time):
    """ACTIVE for 20 s after each click, then SUCCEEDED."""
    return rec.ACTIVE if time < DRIVES[len(_states(time)) - 1][0] + 20.0 else rec.SUCCEEDED


def _driven(report, period):
    """A bridge whose timer reports these lines about a time."""
    goals, statuses = [], []
    for number, (sent, active, end) in enumerate(DRIVES):
        goals.append(rec.SentGoal(str(number), 1.2, -0.4, sent, ""))
        for time, state in ((sent, rec.PENDING), (sent, rec.ACTIVE), (sent + active, end)):
            statuses.append(rec.Status(time, str(number), state))
    times = [1.0 + period * number for number in range(1, round(55.4 / period) + 1)]
    lines = tuple(rec.Line(time, text) for time in times for text in report(time))
    marks = {"watching": 1.0, "watched": 26.0}
    return Record("click", "bridge", goals=tuple(goals), statuses=tuple(statuses), lines=lines, marks=marks)


NAMES = list(rec.STATUS_NAMES)
CZECH = ("ceka", "jede", "zruseno", "hotovo", "prekazka")
LEGEND = "(0 PENDING, 1 ACTIVE, 2 PREEMPTED, 3 SUCCEEDED)"


@pytest.mark.parametrize("period", [0.1, 1.0, 2.0, 5.0, 10.0])
@pytest.mark.parametrize(
    "report",
    [
        lambda time: _named(_states(time)[-1:]),
        lambda time: [f"status {_states(time)[-1]}"],
        lambda time: [f"state: {1 if _states(time)[-1] == rec.ACTIVE else 2}"],  # of actionlib's SimpleGoalState
        lambda time: [f"stav: {CZECH[_states(time)[-1]]}, {time:.1f} s"],
        lambda time: [f"Stav akce: {_states(time)[-1]} {LEGEND}, {time:.1f} s"],
        lambda time: [f"State: {_states(time)[-1]} {LEGEND}"],
        lambda time: [LEGEND, f"stav: {_states(time)[-1]}"],
        lambda time: [f"state: {_states(time)[-1]}", f"previous: {_named(_states(time - 1.0)[-1:])}"],
        lambda time: ["still active"] if _states(time)[-1] == rec.ACTIVE else [],
        lambda time: [str(_named(_states(time, KEPT)))],
        lambda time: _named(_states(time, KEPT)),
        lambda time: _named(_states(time)),
        lambda time: ["The goal is ACTIVE" if _states(time)[-1] == rec.ACTIVE else "There is no ACTIVE goal"],
        lambda time: ["driving" if _states(time)[-1] == rec.ACTIVE else "the last goal was aborted or has succeeded"],
        lambda time: [" ".join(f"{it}={it == NAMES[_states(time)[-1]]}" for it in NAMES)],
        lambda time: [f"{it}: {_states(time).count(state)}" for state, it in enumerate(NAMES)],
        lambda time: [f"connected, {len(_states(time))} goals"],
    ],
)
def test_reports_that_follow_the_truth_pass_in_any_words(report, period):
    assert CHECKS["reports_status"](_driven(report, period), LIMITS) is PASSED


@pytest.mark.parametrize("period", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("told", [rec.STATUS_NAMES, range(5)])
def test_reports_that_are_late_by_one_pass(told, period):
    late = _driven(lambda time: [f"state: {told[_states(max(1.0, time - period))[-1]]}"], period)
    assert CHECKS["reports_status"](late, LIMITS) is PASSED


@pytest.mark.parametrize("period", [0.1, 1.0, 2.0])
@pytest.mark.parametrize(
    "report, words",
    [
        (lambda time: _named([(0, 1, 3)[round(time * 10) // 7 % 3]]), "while the newest goal is ACTIVE"),
        (lambda time: _named([_by_the_clock(time)]), "reports ACTIVE while the newest goal is ABORTED"),
        (lambda time: [f"state: {_by_the_clock(time)}"], SAME_WORDS),
        (lambda time: [f"Stav akce: {_by_the_clock(time)} {LEGEND}"], SAME_WORDS),
        (lambda time: [" ".join(NAMES[int(10.0 * time) % 5 :] + NAMES)], SAME_WORDS),
        (lambda time: ["LOST"], "reports LOST while the newest goal is ACTIVE"),
        (lambda time: ["ACTIVE", "LOST"], SAME_WORDS),
        (lambda time: _named(_states(time, KEPT)[:1]), "reports PREEMPTED while the newest goal is ACTIVE"),
        (lambda time: _named([min(_states(time)[-1], 3)]), "reports SUCCEEDED while the newest goal is ABORTED"),
        (lambda time: _named(_states(time)[-1:]) if time < 37.0 else [], "Nothing is reported while this goal is"),
    ],
)
def test_reports_that_do_not_follow_the_truth_fail(report, words, period):
    verdict = CHECKS["reports_status"](_driven(report, period), LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


@pytest.mark.parametrize("times", [(), (4.0, 22.0, 30.0)])
def test_too_few_reports_while_the_goal_is_active_fail(times):
    verdict = CHECKS["reports_status"](_clicked(1.2, -0.4, *((time, "state") for time in times)), LIMITS)
    assert isinstance(verdict, Failed) and "Too little is logged, printed or published" in verdict.cause


@pytest.mark.parametrize("x", [-0.4, 1.24, math.nan])
def test_goal_elsewhere_than_the_click_fails(x):
    verdict = CHECKS["forwards_goal"](_clicked(x, -0.4), LIMITS)
    assert isinstance(verdict, Failed) and "does not have the click's position" in verdict.cause


def _sent(*positions):
    """Clicks at 1.0 s and at 5.0 s, and goals: when they are sent [s], x and y."""
    goals = tuple(rec.SentGoal(str(number), x, y, time, "") for number, (time, x, y) in enumerate(positions))
    return Record("click", "bridge", clicks=(BEFORE, NEWER), goals=goals)


@pytest.mark.parametrize(
    "goals, words",
    [
        ([(0.5, 1.0, 0.0), (1.0, 1.2, -0.4), (5.0, -0.6, 0.9)], "sends a goal without a click"),
        ([], "No goal was sent"),
        ([(5.0, -0.6, 0.9)], "The click was not forwarded"),
        ([(1.0, 1.2, -0.4)], "The click was not forwarded"),
        ([(1.0, 1.2, -0.4), (5.0, -0.6, 0.9), (6.0, -0.6, 0.9)], "sent more than once"),
        ([(1.0, 1.2, -0.4), (5.0, 1.2, -0.4)], "has the position of the older click"),
    ],
)
def test_each_click_becomes_exactly_one_goal(goals, words):
    assert CHECKS["forwards_goal"](_sent((1.0, 1.2, -0.4), (5.0, -0.6, 0.9)), LIMITS) is PASSED
    verdict = CHECKS["forwards_goal"](_sent(*goals), LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


@pytest.mark.parametrize("time, is_right", [(3.0, False), (5.0, True)])
def test_goal_is_cancelled_only_for_a_newer_click(time, is_right):
    sent = _sent((1.0, 1.2, -0.4), (5.0, -0.6, 0.9))
    record = replace(sent, cancels=(rec.Cancel(time, "0"),), statuses=(rec.Status(time, "0", rec.PREEMPTED),))
    verdict = CHECKS["cancels_older"](record, LIMITS)
    assert isinstance(verdict, Failed) != is_right
    assert is_right or "although no newer click has come" in verdict.cause


@pytest.mark.parametrize("own_server", [0.0, 1.0])
def test_bridge_with_an_action_server_of_its_own_does_not_wait_for_the_real_one(own_server):
    verdict = CHECKS["waits_for_server"](Record("no_server", "bridge", marks={"own_server": own_server}), LIMITS)
    assert isinstance(verdict, Failed) == bool(own_server)
    assert not own_server or "has an action server robocop_goto_as of its own" in verdict.cause


ROBOT, IN_WORLD = Pose2D(0.6, 0.3, 1.0), Pose2D(40.4, -14.3, 1.7)  # from odom and from the world
MAP = compose(ROBOT, inverse(IN_WORLD))  # odom_from_map


def _in_frame(frame, goal):
    """A click at (1.0, 0.2) in a frame becomes a goal."""
    there = compose({"base_footprint": ROBOT, "map": MAP, "odom": Pose2D()}[frame], Pose2D(1.0, 0.2))
    return Record(
        "frame",
        "bridge",
        samples=(rec.Sample(0.9, *ROBOT, *IN_WORLD, 0.0, 0.0, 9.0, False),),
        clicks=(rec.Click(1.0, frame, 1.0, 0.2, there.x, there.y),),
        goals=(rec.SentGoal("g", goal.x, goal.y, 1.0, ""),),
    )


@pytest.mark.parametrize(
    "frame, odom_from_frame, words",
    [
        ("base_footprint", Pose2D(), "base_footprint were passed on as if they were in odom"),
        ("odom", MAP, "does not have the click's position"),
        ("base_footprint", inverse(ROBOT), "does not have the click's position"),
    ],
)
def test_cause_of_a_wrong_transform_is_named(frame, odom_from_frame, words):
    goal = compose(odom_from_frame, Pose2D(1.0, 0.2))
    verdict = CHECKS["goal_frame"](_in_frame(frame, goal), LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


@pytest.mark.parametrize("frame, odom_from_frame", [("base_footprint", ROBOT), ("map", MAP)])
def test_goal_in_odom_passes(frame, odom_from_frame):
    goal = compose(odom_from_frame, Pose2D(1.0, 0.2))
    assert CHECKS["goal_frame"](_in_frame(frame, goal), LIMITS) is PASSED


def test_misspelt_name_of_an_action_client_is_quoted():
    record = replace(_clicked(0.0, 0.0, servers=("/robovop_goto_as", "/other")), goals=())
    verdict = CHECKS["forwards_goal"](replace(record, marks={"clients": 0.0}), LIMITS)
    assert isinstance(verdict, Failed)
    assert verdict.cause == "The action client looks for robovop_goto_as; the handout says robocop_goto_as"


@pytest.mark.parametrize(
    "mark, topic, found, expected, words",
    [
        ("listeners", "/move_base_simple/goal", "a/Pose", "a/PoseStamped", "wrong type, a/Pose; its type is a/PoseS"),
        ("listeners", "/move_base_simple/goal", "a/PoseStamped", "a/PoseStamped", "but with other fields"),
        ("listeners", "/robocop_goto_as/feedback", "a/A", "a/A", "feedback is used with the type a/A, but with other"),
        ("clients", "/robocop_goto_as/goal", "a/TestActionGoal", "x", "The action's type is a/TestAction; the"),
    ],
)
def test_wrong_type_of_a_topic_is_named(mark, topic, found, expected, words):
    record = replace(_clicked(0.0, 0.0), goals=(), marks={mark: 0.0}, other_types=((topic, found, expected),))
    verdict = CHECKS["forwards_goal"](record, LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


def _replaced(*cancels, preempted="older"):
    """A click and a newer one become goals; the one of the id `preempted` is cancelled."""
    goals = rec.SentGoal("older", 1.2, -0.4, 1.0, ""), rec.SentGoal("newer", -0.6, 0.9, 5.0, "")
    statuses = (rec.Status(5.0, preempted, rec.PREEMPTED),)
    return Record("replace", "bridge", clicks=(BEFORE, NEWER), goals=goals, cancels=cancels, statuses=statuses)


@pytest.mark.parametrize(
    "record, words",
    [
        (_replaced(preempted=""), "send_goal() alone does not cancel"),
        (_replaced(rec.Cancel(5.0, "newer"), preempted="newer"), "The newer goal is cancelled, too"),
        (replace(_replaced(), goals=_replaced().goals[:1]), "The click was not forwarded"),
        (replace(_replaced(), goals=_replaced().goals[1:]), "The click was not forwarded"),
    ],
)
def test_cause_of_an_older_goal_that_is_not_replaced_is_named(record, words):
    verdict = CHECKS["cancels_older"](record, LIMITS)
    assert isinstance(verdict, Failed) and words in verdict.cause


def test_older_goal_that_is_cancelled_passes_wherever_the_goals_are():
    assert CHECKS["cancels_older"](replace(_replaced(), clicks=(replace(BEFORE, x=9.0), NEWER)), LIMITS) is PASSED
