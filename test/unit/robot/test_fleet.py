"""A fleet: rows of arrays that Python and C share."""

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.robot.base_controller import Limits
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.robot.model import RobotModel

LIMITS = Limits(0.22, 2.84, 2.5, 3.2, 0.5)


def test_placed_robot_stands_without_a_command_and_keeps_its_wheel_angles(burger: RobotModel) -> None:
    fleet = Fleet([burger] * 2, [LIMITS] * 2, [0.1] * 2)
    for rows in (fleet.velocities, fleet.targets, fleet.twists, fleet.wheel_angles, fleet.wheel_speeds):
        rows[:] = 1.0
    fleet.commands[1], fleet.commanded_at[1] = (0.1, 0.2), 3.0
    fleet.place(1, Pose2D(1.0, 2.0, 3.0))
    state = fleet.state(1)
    assert state.world_from_footprint == fleet.pose(1) == Pose2D(1.0, 2.0, 3.0)
    assert (state.twist, state.wheel_speeds, state.wheel_angles) == (Twist2D(), (0.0, 0.0), (1.0, 1.0))
    for rows in (fleet.commanded_at, fleet.commands, fleet.velocities, fleet.targets):
        assert not rows[1].any()
    assert fleet.state(0).twist == Twist2D(1.0, 1.0), "the other robot drives on"
