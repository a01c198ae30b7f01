"""Advice on source code that is graded fairly and fails now and then in the lab."""

import pytest

from robocop_grading.advice import AUTO_START, WALL_ALARM, WALL_SLEEP, advice


@pytest.mark.parametrize(
    "code",
    [
        "SimpleActionServer('robocop_goto_as', GoToPositionAction, execute_cb=self.execute)",
        "actionlib.SimpleActionServer('robocop_goto_as', GoToPositionAction, self.execute, True)",
        "import actionlib as al; al.SimpleActionServer('a', A, self.execute, auto_start=True)",
    ],
)
def test_server_that_starts_inside_its_constructor_is_named(code):
    assert advice(code) == [f"line 1: {AUTO_START}"]


@pytest.mark.parametrize("begin, sleep", [("import time", "time.sleep"), ("from time import sleep as s", "s")])
def test_sleeping_on_the_wall_clock_is_named_once_with_its_first_line(begin, sleep):
    assert advice(f"{begin}\nwhile True:\n    {sleep}(0.1)\n    {sleep}(1)") == [f"line 3: {WALL_SLEEP}"]


@pytest.mark.parametrize(
    "code",
    ["signal.alarm(1)", "from signal import alarm; alarm(1)", "from signal import *; setitimer(ITIMER_REAL, 0.1, 0.1)"],
)
def test_signals_by_the_wall_clock_are_named(code):
    assert advice(code) == [f"line 1: {WALL_ALARM}"]


@pytest.mark.parametrize(
    "code",
    [
        "actionlib.SimpleActionServer('a', A, self.execute, False)",
        "SimpleActionServer('a', A, execute_cb=f, auto_start=False)",
        "SimpleActionServer('a', A, **options)",
        "SimpleActionServer('a', A, f, auto_start=START)",
        "rospy.sleep(0.1); rate.sleep()",
        "from rospy import sleep; sleep(0.1)",
        "# time.sleep(1)",
        "print 'Python 2'; time.sleep(1)",
        "time.sleep(1)\0",
        "-" * 100_000 + "1",
        "a" + ".b" * 5_000 + "()",
    ],
)
def test_nothing_is_said_of_other_code(code):
    assert advice(code) == []
