"""Camera images agree with the geometry of the world."""

import numpy as np
import pytest
from support import analytic_distances, model_named, world_named

from aro_robocop_goto_as.geometry import Pose2D, compose3, lifted, rotation_matrix
from aro_robocop_goto_as.sensors.camera_image import points_of
from aro_robocop_goto_as.shapes import Box
from aro_robocop_goto_as.world.model import World

KINEMATIC = {"drive": "kinematic", "physics_rate": 60, "imu_rate": 60}
WITH_CAMERA = ["burger_rgbd", "waffle", "waffle_pi", "turtlebot2"]
TOLERANCE = 0.003  # [m] of depth on flat walls; larger at a cylinder's edge, which is seen at a slant


def _image(sim, robot=0):
    while True:
        due = sim.advance({"camera": [robot]})
        if due is not None and due.of("camera"):
            return sim.sensors.camera.images[robot]


def _world_from_camera(model, pose):
    robot = model_named(model)
    assert robot.base_from_camera is not None
    return compose3(compose3(lifted(pose), robot.footprint_from_base), robot.base_from_camera)


def _points(image, world_from_camera, spec):
    """An image's points in the world frame: (height, width, 3) [m]."""
    points = points_of(image.depth, spec).astype(float)
    return points @ rotation_matrix(world_from_camera.orientation).T + np.array(world_from_camera.position)


@pytest.mark.parametrize("model", WITH_CAMERA)
@pytest.mark.parametrize(
    "world, pose",
    [("stage_1", Pose2D(0.0, 0.0, 0.4)), ("maze_1", Pose2D(0.0, 0.0, 0.1)), ("stage_4", Pose2D(-0.7, 0.0, 2.0))],
)
def test_depth_agrees_with_an_analytic_ray_cast(simulator, model, world, pose):
    description = world_named(world)
    walls = World(world, tuple(o for o in description.obstacles if isinstance(o.geometry, Box)), pose, (), "")
    sim = simulator(world, pose, model=model, **KINEMATIC)
    camera, spec = _world_from_camera(model, pose), sim.sensors.camera.specs[0]
    points = _points(_image(sim), camera, spec)
    x, y, _ = camera.position
    away = np.hypot(points[..., 0] - x, points[..., 1] - y)
    bearings = np.arctan2(points[..., 1] - y, points[..., 0] - x)
    compared = 0
    for row in (spec.height // 2, spec.height // 2 - 10, spec.height // 2 + 10):
        on_wall = (points[row, :, 2] > 0.005) & np.isfinite(away[row])
        expected = analytic_distances(walls, x, y, bearings[row][on_wall], 20.0)
        off = np.abs(away[row][on_wall] - expected)
        compared += int((off < TOLERANCE).sum())
        if world != "stage_4":  # where cylinders occlude walls
            assert off.max(initial=0.0) < TOLERANCE
    assert compared > 150


def test_floor_is_at_height_zero_and_sky_infinitely_far(simulator):
    sim = simulator("empty", model="waffle", **KINEMATIC)
    image, spec = _image(sim), sim.sensors.camera.specs[0]
    points = _points(image, _world_from_camera("waffle", Pose2D()), spec)
    assert np.abs(points[70:, :, 2]).max() < 0.001
    assert np.isinf(image.depth[:58]).all()
    assert np.isnan(points_of(image.depth, spec)[:58]).all()


def test_camera_sees_other_robots_but_not_its_own(simulator):
    without_others = _image(simulator("empty", model="burger_rgbd"))
    sim = simulator("empty", Pose2D(), Pose2D(1.0, 0.0), model="burger_rgbd")
    image = _image(sim)
    assert np.isinf(without_others.depth[57]).all()
    assert image.depth[57].min() == pytest.approx(1.0 - 0.045 - 0.032 - 0.069, abs=0.05)
    assert np.isinf(image.depth[57, [0, -1]]).all()
    between_plates = _image(simulator("empty", model="turtlebot2"))
    assert between_plates.depth.min() > 0.6, "not the floor, which is 0.7 m away at the image's lower edge"


def test_images_follow_moving_obstacles_and_world_changes(simulator):
    sim = simulator("stage_3", Pose2D(0.0, 0.0, 0.0), model="burger_rgbd", moving=True, **KINEMATIC)
    first = _image(sim)
    for _ in range(5 * 60):
        sim.advance({})
    later = _image(sim)
    assert (first.depth != later.depth).any()
    sim.change_world(world_named("empty"))
    assert np.isinf(_image(sim).depth[:50]).all()
