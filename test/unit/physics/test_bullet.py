"""The engine on Bullet: a robot's pose is that of its base, wherever its centre of mass is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from lxml import etree
from support import ORIGIN, model_named, world_named

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.physics.bullet import BulletEngine
from aro_robocop_goto_as.physics.quiet_pybullet import pybullet
from aro_robocop_goto_as.robot.base_controller import limits_from
from aro_robocop_goto_as.robot.fleet import Fleet
from aro_robocop_goto_as.simulation.params import SimParams

PLACE = Pose2D(1.0, -2.0, 2.0)


@pytest.fixture(
    name="engine",
    params=[("burger", "-0.02 0.01 0.03"), ("turtlebot2", "0.05 0 0")],
    ids=" at ".join,
)
def _engine(request):
    """A robot whose base_link has its centre of mass at a point; a Burger would tip over one before its wheels."""
    name, centre = request.param
    model = model_named(name)
    root = etree.fromstring(model.physics_urdf)
    inertial = root.find("link[@name='base_link']/inertial")
    for origin in inertial.findall("origin"):
        inertial.remove(origin)
    etree.SubElement(inertial, "origin", xyz=centre)
    limits = limits_from(SimParams.of(cmd_vel_timeout=0.0).limits, model.figures)
    fleet = Fleet([replace(model, physics_urdf=etree.tostring(root, encoding="unicode"))], [limits], [0.2])
    engine = BulletEngine(world_named("empty"), fleet, 240, 20, 1.0)
    engine.reset([PLACE])
    yield engine
    engine.close()


def _state(engine):
    engine.update_fleet()
    return [*engine.fleet.poses[0], *engine.fleet.twists[0]]


def _between_the_wheels(engine):
    """Where base_footprint has to be: x, y [m]."""
    (robot,) = engine._robots
    links = [pybullet.getLinkState(robot.body, wheel, 0, 1, engine.client)[4] for wheel in robot.wheels]
    return np.mean(links, axis=0)[:2].tolist()


def test_robot_is_where_it_is_placed_and_stays_there(engine):
    height = engine.fleet.models[0].footprint_from_base.position[2]
    for place in (PLACE, ORIGIN):
        engine.place(0, place)
        assert _state(engine) == pytest.approx([*place, 0.0, 0.0], abs=1e-9)
        assert engine.body(0).world_from_base.position == pytest.approx((place.x, place.y, height), abs=1e-9)
        assert _between_the_wheels(engine) == pytest.approx(place[:2], abs=1e-3)
        engine.advance(0, 240)
        assert _state(engine) == pytest.approx([*place, 0.0, 0.0], abs=2e-3)


def test_base_stays_where_it_is_while_the_robot_turns_in_place(engine):
    engine.fleet.commands[0] = 0.0, 1.0
    places, speeds = [], []
    for step in range(0, 480, 24):
        engine.advance(step, 24)
        x, y, _, v, w = _state(engine)
        places.append((x, y))
        speeds.append((v, w))
    assert np.abs(np.array(places) - PLACE[:2]).max() < 0.01
    assert np.abs(np.array(speeds[10:]) - [0.0, 1.0]).max() < 0.02
    vx, vy, _ = engine.body(0).linear_velocity
    assert math.hypot(vx, vy) < 0.02
