"""Trajectories of both engines, with all errors of odometry, are those that were recorded."""

import json
import math
import os
from typing import Any, Dict, List

import pytest
from support import ROOT, model_named, world_named

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.factory import make_simulator

B, W, T = "burger", "waffle", "turtlebot2"
RECORDED_AT = (3, 4, 8, 12, 16, 20)  # [s]
CASES: Dict[str, Dict[str, Any]] = {
    "kin1": dict(world="stage_4", spawns=[(B, (-0.7, 0, 0))], seconds=12, drive="kinematic"),
    "kin4": dict(
        world="stage_2",
        spawns=[(B, (-1, 0, 0)), (W, (0, 0, 1)), (T, (1, 0, 2)), (B, (0, 1, 3))],
        seconds=20,
        drive="kinematic",
        odom_slip=0.1,
        encoder_tick=0.0015,
    ),
    "kin_moving": dict(
        world="stage_4",
        spawns=[(B, (-0.7, 0, 0)), (B, (0.7, 0, 2))],
        seconds=20,
        drive="kinematic",
        moving=True,
        odom_wheel_radius_error=0.02,
    ),
    "kin_maze": dict(
        world="maze_1",
        spawns=[(B, (0, 0, 0))],
        seconds=12,
        drive="kinematic",
        physics_rate=60,
        imu_rate=60,
        localization="truth",
    ),
    "wheels1": dict(world="stage_4", spawns=[(B, (-0.7, 0, 0))], seconds=8),
    "wheels3": dict(
        world="stage_2",
        spawns=[(B, (-1, 0, 0)), (W, (0, 0, 1)), (T, (1, 0, 2))],
        seconds=8,
        moving=True,
        odom_source="world",
    ),
}
with open(os.path.join(ROOT, "test", "unit", "data", "trajectories.json")) as recorded:
    RECORDED = json.load(recorded)


def _run(world: str, spawns: Any, seconds: int, **params: Any) -> List[Any]:
    """[step, "truth" or "odom", robot, [x, y, yaw, v, w]] at RECORDED_AT; commands change 10 times a second."""
    robots = [RobotSpec(f"r{i}", model_named(model), Pose2D(*spawn)) for i, (model, spawn) in enumerate(spawns)]
    sim = make_simulator(SimParams.of(**params), world_named(world), robots)
    subscriptions = {sensor: range(len(robots)) for sensor in ("odom", "ground_truth")}
    record: List[Any] = []
    recorded_steps = [second * sim.rate for second in RECORDED_AT]
    for step in range(seconds * sim.rate):
        if step % 24 == 0:
            for robot in range(len(robots)):
                k = step // 24 + 7 * robot
                if k % 5 != 4:
                    sim.command(Twist2D(0.22 * math.sin(0.37 * k) + 0.15, 1.5 * math.cos(0.21 * k)), robot)
        if step == 600:
            sim.place(Pose2D(0.3, 0.4, 1.0))
        if step == 900:
            sim.reset()
        if step + 1 not in recorded_steps:
            sim.step({})
            continue
        seen = sim.step(subscriptions)
        assert seen is not None
        for kind, sensor, rows in (("truth", "ground_truth", seen.fleet), ("odom", "odom", seen.odometry)):
            for robot in seen.of(sensor):
                record.append([step, kind, robot, [*rows.poses[robot].tolist(), *rows.twists[robot].tolist()]])
    sim.close()
    return record


@pytest.mark.parametrize("case", CASES)
def test_trajectories_are_those_that_were_recorded(case: str) -> None:
    found = _run(**CASES[case])
    assert [entry[:3] for entry in found] == [entry[:3] for entry in RECORDED[case]]
    for entry, expected in zip(found, RECORDED[case]):
        assert entry[3] == pytest.approx(expected[3], abs=1e-6), entry[:3]
