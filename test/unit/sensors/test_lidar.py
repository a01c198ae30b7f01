"""Beams of a scanner, and ranges with its noise: lidar.c against its definition in NumPy."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.raycast.caster_library import load
from aro_robocop_goto_as.sensors.lidar import Lidar
from aro_robocop_goto_as.sensors.noise_streams import Episode
from aro_robocop_goto_as.sensors.scan_profiles import Accuracy, LidarSpec


def _normals(seed: int, stream: int, step: int, count: int) -> np.ndarray:
    """Standard normal numbers (count,) of lidar.c."""
    normals = np.zeros(count)
    load().aro_normals(seed, stream, step, count, normals.ctypes.data)
    return normals


def _defined(spec: LidarSpec, distances: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Ranges [m] from distances [m] and standard normal numbers, all of the same shape."""
    errors = spec.noise * normals
    if spec.accuracy:
        bounds, metres, shares = np.array(spec.accuracy).T
        entry = np.minimum(np.searchsorted(bounds, distances), len(bounds) - 1)
        limits = metres[entry] + shares[entry] * np.minimum(distances, spec.range_max)
        errors = limits * np.clip(normals / 2.0, -1.0, 1.0)
    ranges = distances + errors
    rounded = np.round(ranges / spec.step) * spec.step if spec.step else ranges.copy()
    rounded[ranges < spec.range_min] = 0.0 if spec.zero_is_none else -np.inf
    rounded[ranges > spec.range_max] = 0.0 if spec.zero_is_none else np.inf
    return rounded


@given(
    st.lists(st.floats(0.0, 12.0) | st.sampled_from([0.12, 0.3, 10.0, math.inf]), min_size=2, max_size=40),
    st.sampled_from([0.0, 0.01, 3.0]),
    st.sampled_from([(), (Accuracy(0.3, 0.01, 0.0), Accuracy(6.0, 0.0, 0.03)), (Accuracy(5.0, 0.1, 0.1),)]),
    st.sampled_from([0.0, 0.001, 0.25]),
    st.booleans(),
    st.lists(st.integers(0, 4), max_size=5, unique=True),
    st.tuples(st.integers(0, 2**31), st.integers(0, 2**40)),
)
def test_ranges_are_those_of_the_definition(
    distances: "list[float]",
    noise: float,
    accuracy: "tuple[Accuracy, ...]",
    step: float,
    zero_is_none: bool,
    robots: "list[int]",
    at: "tuple[int, int]",
) -> None:
    samples = len(distances)
    spec = LidarSpec(0.0, 6.0, samples, 0.12, 10.0, noise, accuracy, step, zero_is_none)
    rows = np.array([np.roll(distances, robot) for robot in range(5)])
    ranges = rows.copy()
    Lidar(spec).measuring(robots, Episode(*at), ranges)()
    for robot, row in enumerate(rows):
        if robot not in robots:
            np.testing.assert_array_equal(ranges[robot], row)
            continue
        np.testing.assert_array_equal(ranges[robot], _defined(spec, row, _normals(at[0], robot, at[1], samples)))


def test_noise_is_standard_normal() -> None:
    normals = np.sort(_normals(1, 0, 1, 200_001))
    expected = [(1.0 + math.erf(z / math.sqrt(2.0))) / 2.0 for z in normals]
    assert np.abs(np.arange(200_001) / 200_001 - expected).max() < 0.004  # Kolmogorov-Smirnov, p = 0.003


def test_noise_differs_between_seeds_robots_and_steps() -> None:
    streams = [_normals(seed, robot, step, 2000) for seed in (1, 2) for robot in (0, 1) for step in (0, 1, 2)]
    streams += [stream[1:] for stream in streams[:1]]
    correlations = np.corrcoef([stream[:1999] for stream in streams]) - np.eye(len(streams))
    assert np.abs(correlations).max() < 0.12
    np.testing.assert_array_equal(streams[0], _normals(1, 0, 0, 2000))
