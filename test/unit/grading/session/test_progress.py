"""A scenario ends when the robot makes no progress towards any goal that has not ended."""

from aro_robocop_goto_as.geometry import Pose2D
from robocop_grading.handout import Limits
from robocop_grading.record import SentGoal
from robocop_grading.session.progress import Progress

OLDER, NEWER = SentGoal("older", 2.0, 0.0, 0.0, "PREEMPTED"), SentGoal("newer", 0.5, -0.6, 3.0, "SUCCEEDED")
AWAY = [Pose2D(0.6 + 0.02 * tick, 0.0) for tick in range(71)]  # to the older goal at 0.2 m/s, away from the newer one


def longest(poses, running, progress, since=0.0):
    """The longest time [s] without progress while the robot has these poses, one each 0.1 s from a time [s] on."""
    return max(progress.missing_for(pose, running, since + 0.1 * tick) for tick, pose in enumerate(poses))


def test_way_to_an_older_goal_that_has_not_ended_is_progress():
    assert longest(AWAY, [NEWER], Progress(Limits())) > 6.0
    assert longest(AWAY, [OLDER, NEWER], Progress(Limits())) < 0.5


def test_time_starts_anew_when_a_goal_ends():
    progress = Progress(Limits())
    longest(AWAY, [OLDER, NEWER], progress)
    turning = [Pose2D(2.0, 0.0, -0.05 * tick) for tick in range(51)]  # at 0.5 rad/s, from 159 degrees to the newer goal
    assert longest(turning, [NEWER], progress, since=7.1) < 0.5


def test_standing_still_is_no_progress():
    assert longest([Pose2D()] * 91, [OLDER, NEWER], Progress(Limits())) > Limits().stall


def test_nothing_is_missing_when_all_goals_have_ended():
    assert Progress(Limits()).missing_for(Pose2D(), [], 100.0) == 0.0
