"""The last goals and what became of them."""

from aro_robocop_goto_as.web.goal_history import REMEMBERED, GoalHistory


def test_the_history_holds_the_last_goals_with_their_positions() -> None:
    history = GoalHistory()
    for number in range(3 * REMEMBERED):
        history.sent(f"goal {number}", float(number), 0.0)
    last = 3 * REMEMBERED - 1
    history.ended("", f"goal {last}", "SUCCEEDED", "REACHED")
    history.ended("", "goal 0", "ABORTED", "OBSTACLE")
    newest, older = history.latest()
    assert older.goal == (float(last), 0.0) and newest.goal is None
    for _ in range(3 * REMEMBERED):
        history.ended("", "x", "ABORTED", "")
    assert len(history.latest()) == REMEMBERED
