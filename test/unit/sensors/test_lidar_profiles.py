"""Scan profiles: figures, quirks of real drivers, and overrides by parameters."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.sensors.lidar import PROFILES, RangeErrors
from aro_robocop_goto_as.sensors.sensor import Episode
from aro_robocop_goto_as.simulation.params import SimParams


def _measured(profile, distances, **changes):
    changed = replace(PROFILES[profile], samples=len(distances), **changes)
    ranges = np.array([distances])
    RangeErrors(changed).adding([0], Episode(1, 2), ranges)()
    return ranges[0].tolist()


def _scans(sim, count):
    found = []
    while len(found) < count:
        due = sim.advance({"scan": [0]})
        found += [sim.sensors.lidar.ranges[0].copy()] if due is not None and due.of("scan") else []
    return found


def test_the_default_is_the_labs_gazebo_sensor_with_its_beams_as_lab_code_spreads_them():
    spec = SimParams().sensors.lidar.profile()
    assert (spec.rate, spec.samples, spec.angle_min, spec.angle_max) == (10, 360, 0.0, 6.28319)
    assert (spec.range_min, spec.range_max, spec.noise) == (0.12, 10.0, 0.01)
    assert len(np.arange(spec.angle_min, spec.angle_max + spec.increment, spec.increment)) == 360
    inc = np.float32(spec.increment)
    assert len(np.arange(np.float32(spec.angle_min), np.float32(spec.angle_max) + inc / 2, inc)) == 360


@pytest.mark.parametrize(
    "profile, ranges",
    [
        ("gazebo", [-math.inf, 0.12, 1.23449, 3.5, 3.51, math.inf]),
        ("lds01", [0.0, 0.12, 1.234, 3.5, 0.0, 0.0]),  # in whole millimetres
    ],
)
def test_what_is_too_near_or_too_far_is_reported_as_the_scanners_driver_does(profile, ranges):
    measured = _measured(profile, [0.119, 0.12, 1.23449, 3.5, 3.51, math.inf], noise=0.0)
    assert measured == pytest.approx(ranges, abs=1e-12)


def test_ideal_scans_are_exact(simulator):
    sim = simulator("stage_1", scan_profile="ideal")
    (scan,) = _scans(sim, 1)
    assert (scan == sim.exact_distances()).all()


@pytest.mark.parametrize("distance, limit", [(0.2, 0.010), (0.3, 0.010), (1.0, 0.03), (6.0, 0.18), (7.0, 0.35)])
def test_an_lds02s_error_stays_within_its_accuracy(distance, limit):
    errors = np.array(_measured("lds02", [distance] * 10_000)) - distance
    assert (errors.min(), errors.max()) == pytest.approx((-limit, limit), rel=1e-9)
    assert errors.std() == pytest.approx(0.48 * limit, rel=0.03)  # of a normal distribution cut at two sigma


@pytest.mark.parametrize("profile, samples", [("lds01", 360), ("lds02", 230)])
def test_an_lds_divides_a_full_turn_among_its_beams(simulator, profile, samples):
    assert PROFILES[profile].increment * samples == pytest.approx(2.0 * math.pi)
    (scan,) = _scans(simulator("stage_1", Pose2D(0.5, 0.0), scan_profile=profile, scan_noise=0.0), 1)
    assert len(scan) == samples
    assert (scan[0], scan[samples // 2]) == pytest.approx((1.85 - 0.5 + 0.032, 1.85 + 0.5 - 0.032), abs=1e-3)


def test_explicit_value_overrides_the_profile_and_is_listed():
    given = {"scan_rate": 5, "scan_noise": 0.02, "scan_angle_min": 0.0, "scan_angle_max": 3.0}
    scan = SimParams.of(scan_profile="lds02", **given).sensors.lidar
    assert scan.given() == given
    spec = scan.profile()
    assert (spec.rate, spec.noise, spec.accuracy, spec.angle_min, spec.angle_max) == (5, 0.02, (), 0.0, 3.0)
    assert (spec.samples, spec.range_max) == (230, 8.0)
    assert SimParams().sensors.lidar.given() == {}
