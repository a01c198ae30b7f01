"""When the server's node is replaced by a new one."""

from dataclasses import replace

import pytest
from grading_records import LIMITS, RIGHT

from robocop_grading import record as rec
from robocop_grading.session.server_run import ServerRun


@pytest.mark.parametrize("status, expected", [(rec.PREEMPTED, False), (rec.RECALLED, False), (rec.ABORTED, True)])
def test_cancelled_goal_may_be_recalled_or_preempted(status, expected):
    run = ServerRun.__new__(ServerRun)  # without a simulation
    run.limits = LIMITS
    goal, result = replace(RIGHT.goals[0], ends="PREEMPTED"), replace(RIGHT.results[0], status=status)
    assert run._unexpected(replace(RIGHT, goals=(goal,), results=(result,))) is expected
