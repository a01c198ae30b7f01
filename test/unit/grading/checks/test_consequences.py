"""Conditions of the table of consequences that no pair of mistakes shows."""

from dataclasses import replace

import pytest
from grading_records import RIGHT

from robocop_grading.checks.consequences import slow_loop
from robocop_grading.checks.verdict import Failed, Kind


@pytest.mark.parametrize(
    "commands, feedback, ends, is_slow",
    [
        pytest.param(10, 10, True, True, id="both at 1 Hz"),
        pytest.param(1, 10, True, False, id="only the feedback at 1 Hz"),
        pytest.param(1, 10, False, False, id="likewise, and the goal does not end"),
        pytest.param(10, 1000, True, False, id="no feedback, and a command now and then"),
    ],
)
def test_a_loop_is_slow_if_feedback_and_commands_come_as_seldom(commands, feedback, ends, is_slow):
    record = replace(RIGHT, commands=RIGHT.commands[::commands], feedback=RIGHT.feedback[1::feedback])
    record = record if ends else replace(record, results=(), statuses=())
    earlier = Failed("about 10 Hz", "1 Hz", 0.0, "", Kind.TOO_LITTLE)
    assert slow_loop(record, Failed("", "", 0.0, "", Kind.LONG_TURN), earlier) is is_slow
