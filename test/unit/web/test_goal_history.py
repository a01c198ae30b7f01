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


def test_a_goal_without_an_id_is_recognised_by_the_one_that_its_server_gives_it():
    history = GoalHistory()
    history.sent("named", 1.0, 0.0)
    history.sent("", 2.0, 0.0)
    assert history.position("named") == (1.0, 0.0)
    assert history.position("first") == (2.0, 0.0)
    history.sent("", 3.0, 0.0)
    history.ended("", "first", "PREEMPTED", "")
    history.ended("", "second", "SUCCEEDED", "")
    assert [ended.goal for ended in history.latest()] == [(3.0, 0.0), (2.0, 0.0)]
