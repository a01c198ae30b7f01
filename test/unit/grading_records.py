"""The plan; a recorded run of a right server, and changed ones; results of a class."""

import math
import tempfile
from dataclasses import replace
from pathlib import Path

from support import ROOT

from robocop_grading import record as rec
from robocop_grading.checks import Failed
from robocop_grading.grades import CheckOutcome, CheckResult, Grade
from robocop_grading.handout import Limits
from robocop_grading.judge import judge
from robocop_grading.plan_file import load
from robocop_grading.record import Record
from robocop_grading.report.write import write

PLAN_FILE = Path(ROOT, "config", "grading.yaml")
PLAN = load(PLAN_FILE)
CANCEL = next(check.points for check in PLAN.checks if check.name == "cancel")
LIMITS = Limits()
GOAL = rec.SentGoal("g", 1.0, 1.0, 0.0, "SUCCEEDED")


def drive():
    """A run: the robot turns by 45 degrees in 2 s, then drives to the goal in 8 s, with feedback at every tick."""
    samples = []
    commands, feedback = [], []
    far = math.hypot(1.0, 1.0) - 0.09
    for tick in range(131):
        t = tick / 10.0
        turn, way = min(1.0, t / 2.0), max(0.0, min(1.0, (t - 2.0) / 8.0))
        yaw, along = turn * math.pi / 4.0, way * far
        x, y = along * math.cos(math.pi / 4.0), along * math.sin(math.pi / 4.0)
        moving = 2.0 <= t < 10.0
        v, w = far / 8.0 if moving else 0.0, math.pi / 8.0 if t < 2.0 else 0.0
        samples.append(rec.Sample(t, x, y, yaw, x + 40.0, y - 15.0, yaw + 0.7, v, w, math.inf, False))
        if t <= 10.0:
            commands.append(rec.Command(t, 0.16 if moving else 0.0, 0.39 if t < 2.0 else 0.0))
            error = GOAL.errors_at(samples[-1])
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


RIGHT = drive()


def changed(**fields):
    return replace(RIGHT, **fields)


def fed_back(position=lambda error: error, angle=lambda error: error):
    """The same run with different values in its feedback."""
    told = [(it, position(it.position_error), angle(it.angle_error)) for it in RIGHT.feedback]
    return changed(feedback=tuple(replace(it, position_error=d, angle_error=a) for it, d, a in told))


def commanded(change):
    return changed(commands=tuple(change(it) for it in RIGHT.commands))


def graded(*records, problem=""):
    """The grade of one part that left these records."""
    part = records[0].part
    return judge("anna", PLAN, {part: {record.name: record for record in records}}, {part: problem})


def judged(name, part, points, cause="", extra=False, follows=""):
    """The result of a check, failed if there is a cause."""
    failure = Failed("", "", 0.0, cause) if cause else None
    outcome = CheckOutcome.FAILED if cause else CheckOutcome.PASSED
    return CheckResult(name, part, "", outcome, points, 1.0, extra, failure=failure, follows=follows)


def keep(results, name, cause="", follows="", digest=None):
    """Store the report of a hand-in with one check, as a worker does."""
    keep_grade(results, Grade(name, (judged("cancel", "server", 0.2, cause, follows=follows),)), digest)


def keep_grade(results, grade, digest=None):
    """Store the report of a grade."""
    with tempfile.TemporaryDirectory() as folder:
        write(grade, PLAN, {}, Path(folder))
        results.keep(grade.name, f"digest of {grade.name}" if digest is None else digest, Path(folder))


# A class: Anna is judged, Ben handed in no bridge, nothing of Carl is gradable.
GROUP = (
    Grade(
        "=anna",
        (
            judged("cancel", "server", 0.0, "<cause> at 1.5"),
            judged("action_server", "server", 0.5),
            judged("goal_frame", "bridge", 1.0, extra=True),
        ),
    ),
    Grade("ben", (judged("cancel", "server", 0.0, "<cause> at -3"),), ("=cmd",)),
    Grade("carl", (), ("nothing to grade",)),
)
