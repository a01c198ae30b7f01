"""Two mistakes in one server that were once judged wrongly: the report names what each explains, and nothing else.

All pairs of mistakes are judged over recordings, in test/unit/grading/test_pairs.py.
"""

import pytest
from graded import graded
from right_solutions import SERVER, TURN, changed

from robocop_grading.grades import CheckOutcome

LOOP = "        while not rospy.is_shutdown():\n"
DRIVES_FIRST = ((LOOP, f"        self.drive(0.15, 0.0)\n        rospy.sleep(1.0)\n{LOOP}"),)
NEVER_ENDS = (
    ("if position_error < 0.1:", "if position_error < 0.0:"),
    ("abs(angle_error) > 0.1:", "abs(angle_error) > 0.1 and position_error > 0.1:"),
    ("self.drive(0.2,", "self.drive(0.0 if position_error < 0.1 else 0.2,"),
)
NEVER_PREEMPTED = (("if self.server.is_preempt_requested():", "if False:"),)
TURNS_SLOWLY = ((TURN, TURN.replace("0.8", "0.5")),)  # allowed
LOST_BY_DRIVING_FIRST = "turns_to_goal already_there stops_at_obstacle"
LOST_BY_NEVER_ENDING = (
    "reaches_goal goal_behind already_there far_goal only_ahead_counts odd_scans newer_goal next_goal success_result"
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes, lost",
    [
        ((*DRIVES_FIRST, *NEVER_ENDS), f"{LOST_BY_DRIVING_FIRST} {LOST_BY_NEVER_ENDING}"),
        ((*NEVER_PREEMPTED, *TURNS_SLOWLY), "cancel newer_goal"),
    ],
    ids=["drives first and never ends", "never preempted and turns slowly"],
)
def test_report_names_what_its_mistakes_explain_and_nothing_else(changes, lost, tmp_path):
    grade = graded("two mistakes", changed("two mistakes", SERVER, changes), tmp_path)
    assert not grade.tracebacks and grade.mistakes
    assert {it.name for it in grade.checks if it.outcome is not CheckOutcome.PASSED} <= {*lost.split()}
