"""Where there is room for a robot."""

from typing import Callable

import pytest
from support import ORIGIN

from aro_robocop_goto_as.errors import PlaceError
from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.simulation.simulator import Simulator


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_robot_has_room_where_it_touches_neither_a_wall_nor_another_robot(
    simulator: Callable[..., Simulator], drive: str
) -> None:
    sim = simulator("stage_1", ORIGIN, Pose2D(1.0, 0.0), drive=drive)
    for pose, reason in (
        (
            Pose2D(1.8, 0.0),
            "x 1.800 y 0.000 is 0.050 m from 'walls/.*', expected at least the robot's radius of 0.105 m",
        ),
        (Pose2D(1.9, 1.9), "is 0.000 m from 'walls/"),
        (Pose2D(1.15, 0.0), "is 0.150 m from robot 'robot_2', expected at least 0.21 m"),
    ):
        with pytest.raises(PlaceError, match=reason):
            sim.place_with_room(pose, 0)
        assert sim.world_from_footprint() == ORIGIN
    for pose in (Pose2D(0.05, 0.0), Pose2D(1.0, 0.3), Pose2D(1.7, 1.7)):  # the first overlaps only its own place
        sim.place_with_room(pose, 0)
        assert sim.world_from_footprint() == pytest.approx(pose, abs=1e-9)
