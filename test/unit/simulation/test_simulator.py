"""The simulator: rates, subscriptions, odometry, places, and several robots."""

import math
from dataclasses import replace

import pytest
from support import ORIGIN, driven, everything

from aro_robocop_goto_as.errors import PlaceError
from aro_robocop_goto_as.floor_plan.occupancy import FREE, OCCUPIED
from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D, compose

KINEMATIC = {"drive": "kinematic", "physics_rate": 60, "imu_rate": 60}
DRIVES = [{"drive": "wheels"}, KINEMATIC]


def _odom(sim):
    """odom_from_footprint at the next update."""
    due = None
    while due is None or not due.of("odom"):
        due = sim.advance({"odom": [0]})
    return Pose2D(*sim.sensors.odometry.poses[0].tolist())


@pytest.mark.parametrize("params", DRIVES)
def test_robot_placed_in_a_wall_touches_it_at_once(simulator, params):
    sim = simulator("stage_1", Pose2D(1.86, 0.0), **params)
    sim.advance({})
    assert sim.newly_placed_in_contact() == [0] and sim.newly_placed_in_contact() == []
    sim.place(ORIGIN)
    sim.advance({})
    assert not sim.touching() and sim.newly_placed_in_contact() == []


# Rates, noise, subscriptions


def test_every_rate_parameter_is_kept(simulator):
    rates = dict(scan=3, odom=4, joint_state=5, imu=6, ground_truth=8, bumper=10, camera=12)
    given = {f"{name}_rate": rate for name, rate in rates.items()}
    given.update(physics_rate=600, clock_rate=1, control_rate=2, camera_width=8, camera_height=6)
    sim = simulator("empty", model="waffle", drive="kinematic", **given)
    seen = driven(sim, STANDSTILL, 1.0, everything(sim))
    rates.update(joint_states=rates.pop("joint_state"), ground_truth_odom=rates.pop("ground_truth"))
    assert {topic: sum(bool(due.of(topic)) for due in seen) for topic in rates} == rates
    assert (sum(due.clock for due in seen), sum(due.control for due in seen)) == (1, 2)


@pytest.mark.parametrize("sensors", [(), ("odom", "scan"), ("imu",)])
def test_advancing_to_what_is_due_next_equals_single_steps(simulator, sensors):
    def run(most):
        sim = simulator("stage_4", Pose2D(-0.7, 0.0), drive="kinematic", moving=True)
        seen = []
        while sim.steps < 240:
            sim.command(Twist2D(0.1, 0.5) if sim.steps < 120 else STANDSTILL)
            due = sim.advance({sensor: [0] for sensor in sensors}, most)
            if due is not None:
                arrays = (sim.sensors.odometry.poses, sim.sensors.lidar.ranges, sim.sensors.imu.samples)
                seen.append((sim.stamp_ns, due.clock, [rows.tobytes() for rows in arrays]))
        return [*seen, sim.world_from_footprint()]

    assert run(1) == run(10**9)


def test_what_is_measured_does_not_depend_on_what_else_is_subscribed(simulator):
    def run(listening):
        sim = simulator("stage_2", Pose2D(), Pose2D(1.0, 0.0))
        for step in range(120):
            sim.command(Twist2D(0.2, 0.3))
            sim.advance(everything(sim) if listening else {"scan": [1]} if step == 119 else {})
        return list(sim.sensors.lidar.ranges[1]), sim.world_from_footprint()

    assert run(True) == run(False)


# Odometry in the simulator


def _odom_and_truth(sim):
    driven(sim, Twist2D(0.2, 0.0), 8.0, ["odom"])
    return Pose2D(*sim.sensors.odometry.poses[0].tolist()), sim.world_from_footprint()


def test_slip_makes_odometry_overestimate_and_turn_reproducibly(simulator):
    odom, truth = _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))
    assert odom.x > 1.02 * truth.x
    assert odom.yaw != 0.0
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, **KINEMATIC))[0] == odom
    assert _odom_and_truth(simulator("empty", odom_slip=0.05, seed=2, **KINEMATIC))[0] != odom


def test_odometry_of_the_world_is_the_truth_wherever_the_robot_is_placed(simulator):
    errors = dict(odom_wheel_radius_error=0.1, odom_slip=0.1, encoder_tick=0.1)
    sim = simulator("stage_4", Pose2D(-0.7, 0.0, 0.5), odom_source="world", **errors)
    assert _odom(sim) == sim.world_from_footprint()
    sim.place(Pose2D(1.0, -1.0, 1.0))
    driven(sim, Twist2D(0.2, 0.3), 1.0, ["odom"])
    odom = sim.sensors.odometry
    assert (Pose2D(*odom.poses[0]), Twist2D(*odom.twists[0])) == (sim.world_from_footprint(), sim.velocity())
    assert sim.map_from_odom() == Pose2D()


def test_true_localization_follows_odometrys_errors(simulator):
    sim = simulator("empty", localization="truth", odom_wheel_radius_error=0.1, **KINEMATIC)
    odom, truth = _odom_and_truth(sim)
    assert compose(sim.map_from_odom(), odom) == pytest.approx(truth)
    assert sim.map_from_odom().x < -0.1


# Places and resets


@pytest.mark.parametrize(
    "params, accuracy", [({}, 1e-9), ({"encoder_tick": 0.0015}, 1e-3), ({"odom_slip": 0.05}, 0.012)]
)
def test_placing_the_robot_between_odometry_updates_loses_no_travel(simulator, params, accuracy):
    sim = simulator("empty", drive="kinematic", max_linear_acceleration=1e3, odom_rate=10, **params)
    driven(sim, Twist2D(0.2, 0.0), (240 + 23) / 240, ["odom"])  # 23 of the 24 steps between two updates
    sim.place(Pose2D(1.0, -1.0, 1.0))
    assert compose(sim.map_from_odom(), _odom(sim)) == pytest.approx((1.0, -1.0, 1.0), abs=accuracy)


# Several robots


def test_map_of_a_world_shows_what_is_at_the_scanners_height_and_what_robots_reach(simulator):
    occupancy = simulator("stage_1", ORIGIN, Pose2D(9.0, 0.0)).occupancy()

    row = occupancy.cells[int(-occupancy.origin.y / occupancy.resolution)]
    at_start, before_wall, wall, outside = (
        int(row[int((x - occupancy.origin.x) / occupancy.resolution)]) for x in (0.0, 1.8, 1.849, 2.2)
    )
    assert (at_start, before_wall, wall, outside) == (FREE, FREE, OCCUPIED, FREE)


def test_map_of_a_world_made_from_a_map_stays_as_it_was_loaded_when_a_model_is_deleted(simulator):
    sim = simulator("stage_1", ORIGIN)
    loaded = sim.occupancy()
    sim.change_world(replace(sim.world, occupancy=loaded, obstacles=()))
    assert sim.occupancy() is loaded


@pytest.mark.parametrize("params", DRIVES)
def test_two_robots_driving_towards_each_other_collide_and_stop(simulator, params):
    sim = simulator("empty", ORIGIN, Pose2D(0.6, 0.0, math.pi), **{**params, "cmd_vel_timeout": 0.0})
    sim.command(Twist2D(0.15, 0.0), robot=0)
    driven(sim, Twist2D(0.15, 0.0), 4.0, robot=1)
    assert sim.touching(0) and sim.touching(1)
    assert sim.world_from_footprint(1).x - sim.world_from_footprint(0).x > 0.05


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_robot_has_room_where_it_touches_neither_a_wall_nor_another_robot(simulator, drive):
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
            sim.require_room(pose, 0)
    for pose in (Pose2D(0.05, 0.0), Pose2D(1.0, 0.3), Pose2D(1.7, 1.7)):  # the first overlaps only its own place
        sim.require_room(pose, 0)
        sim.place(pose, 0)
        assert sim.world_from_footprint() == pytest.approx(pose, abs=1e-9)
