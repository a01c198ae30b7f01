"""A recorded run of a right server, and changed ones, for the tests of checks and judge."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, List

from support import ROOT

from robocop_grading import record as rec
from robocop_grading.handout import Limits
from robocop_grading.record import Record

PLAN = Path(ROOT, "config", "grading.yaml")
LIMITS = Limits()
GOAL = rec.Goal("g", 1.0, 1.0, 0.0, "SUCCEEDED")


def drive() -> Record:
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


RIGHT = drive()


def changed(**fields: Any) -> Record:
    return replace(RIGHT, **fields)


def fed_back(position: Any = None, angle: Any = None) -> Record:
    """The same run with different values in its feedback."""
    return changed(
        feedback=tuple(
            replace(
                it,
                position_error=position(it.position_error) if position else it.position_error,
                angle_error=angle(it.angle_error) if angle else it.angle_error,
            )
            for it in RIGHT.feedback
        )
    )


def commanded(change: Any) -> Record:
    return changed(commands=tuple(change(it) for it in RIGHT.commands))
