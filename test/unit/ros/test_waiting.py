"""Waiting for a condition."""

from aro_robocop_goto_as.ros.waiting import wait_until


def test_wait_until_says_whether_the_condition_became_true():
    answers = iter([False, False, True])
    assert wait_until(lambda: next(answers), 10.0, 0.0)
    assert not wait_until(lambda: False, 0.0)
