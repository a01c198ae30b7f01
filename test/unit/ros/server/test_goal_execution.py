"""One goal's control periods: when lack of progress ends it."""

import math
from typing import Iterable, List, Optional, Tuple, cast

import pytest
from aro_robocop_goto_as.msg import GoToPositionGoal
from geometry_msgs.msg import Point

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.goto import Outcome
from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.ros.server.goal_execution import GoalExecution
from aro_robocop_goto_as.ros.server.inputs import Inputs

PERIOD = 100  # [ms] of the control loop


class BlockedRobot:
    """Inputs of a robot that never moves, with nothing ahead."""

    odom = None  # whose frame a text would name

    def read(self) -> Tuple[Pose2D, float]:
        """The same pose every time."""
        return Pose2D(), math.inf


class TurningRobot(BlockedRobot):
    """One that turns past the goal to and fro, as late commands have it do: to the other side every 4 s."""

    def __init__(self) -> None:
        self._reads = 0

    def read(self) -> Tuple[Pose2D, float]:
        """Heading 0.5 rad beside the goal."""
        self._reads += 1
        return Pose2D(yaw=0.5 if self._reads // (4_000 // PERIOD) % 2 else -0.5), math.inf


class CarriedRobot(BlockedRobot):
    """One that drives straight to the goal, and is carried away just before it arrives, to drive there once more."""

    def __init__(self) -> None:
        self._xs = iter([*(0.02 * tick for tick in range(44)), *(-3.0 + 0.02 * tick for tick in range(200))])

    def read(self) -> Tuple[Pose2D, float]:
        """0.02 m nearer each time."""
        return Pose2D(next(self._xs)), math.inf


class FlickeringRobot(BlockedRobot):
    """One that stands still, and whose localization can't decide between two places."""

    def __init__(self) -> None:
        self._reads = 0

    def read(self) -> Tuple[Pose2D, float]:
        """The other place every 4 s."""
        self._reads += 1
        return Pose2D(-1.0 if self._reads // (4_000 // PERIOD) % 2 else 0.0), math.inf


def end_of_goal(ticks: Iterable[int], inputs: Optional[BlockedRobot] = None) -> Tuple[int, Outcome]:
    """The time [ms] at which a goal ahead of the robot ends, and how, with a step at each of these times."""
    p, inputs = GotoParams(), inputs or BlockedRobot()
    goal = GoalExecution(GoToPositionGoal(Point(1.0, 0.0, 0.0)), cast(Inputs, inputs))
    for tick in ticks:
        goal.begin_period(tick / 1000.0, p)
        pose, clearance = inputs.read()
        ending = goal.ending(goal.decide(pose, clearance, p), clearance, p)
        if ending is not None:
            return tick, ending.outcome
    raise AssertionError("the goal did not end")


def test_goal_without_progress_ends_after_the_timeout() -> None:
    assert end_of_goal(range(0, 20_000, PERIOD)) == (5_000 + PERIOD, Outcome.STUCK)


@pytest.mark.parametrize("gap", [1_000, 6_000, 60_000])
def test_time_in_which_the_server_did_not_run_is_no_lack_of_progress(gap: int) -> None:
    before = list(range(0, 1_000, PERIOD))
    after: List[int] = list(range(before[-1] + gap, before[-1] + gap + 20_000, PERIOD))
    ended, outcome = end_of_goal(before + after)
    assert outcome is Outcome.STUCK
    assert ended == pytest.approx(5_000 + gap, abs=3 * PERIOD)


def test_a_turn_at_a_lower_speed_gets_its_own_time_and_there_are_two_of_them() -> None:
    ended, outcome = end_of_goal(range(0, 60_000, PERIOD), TurningRobot())
    assert outcome is Outcome.STUCK
    assert ended == pytest.approx(8_000 + 5_000, abs=3 * PERIOD)


def test_robot_that_is_carried_away_gets_its_time_anew() -> None:
    assert end_of_goal(range(0, 60_000, PERIOD), CarriedRobot())[1] is Outcome.REACHED


def test_odometry_that_jumps_for_ever_does_not_keep_a_goal_alive() -> None:
    ended, outcome = end_of_goal(range(0, 600_000, PERIOD), FlickeringRobot())
    assert outcome is Outcome.STUCK and ended < 100_000
