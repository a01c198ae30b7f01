"""Rays of Bullet itself, for comparison with ours."""

import numpy as np

from aro_robocop_goto_as.geometry import Vector3
from aro_robocop_goto_as.physics.bullet import BulletEngine
from aro_robocop_goto_as.physics.bullet_obstacles import WORLD_GROUP
from aro_robocop_goto_as.physics.quiet_pybullet import pybullet
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.world.model import World


def bullet_engine(world: World) -> BulletEngine:
    """An engine with a world and no robots."""
    engine = BulletEngine(world, Fleet([], [], []), 240, 20, 1.0)
    engine.reset([])
    return engine


def bullet_rays(engine: BulletEngine, start: Vector3, ends: np.ndarray) -> np.ndarray:
    """Hit fractions (n,) of Bullet's rays from `start` [m] to `ends` (n, 3) [m]; 1.0 = no hit."""
    hits = pybullet.rayTestBatch(
        [start] * len(ends), ends.tolist(), collisionFilterMask=WORLD_GROUP, physicsClientId=engine.client
    )
    return np.array([hit[2] for hit in hits])
