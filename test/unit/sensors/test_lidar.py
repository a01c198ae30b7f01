"""Beams of a scanner, and ranges with its noise: lidar.c against its definition in NumPy."""

import math

import numpy as np

from aro_robocop_goto_as.raycast.beams import load


def _normals(seed, stream, step, count):
    """Standard normal numbers (count,) of lidar.c."""
    normals = np.zeros(count)
    load().aro_normals(seed, stream, step, count, normals.ctypes.data)
    return normals


def test_noise_is_standard_normal():
    normals = np.sort(_normals(1, 0, 1, 200_001))
    expected = [(1.0 + math.erf(z / math.sqrt(2.0))) / 2.0 for z in normals]
    assert np.abs(np.arange(200_001) / 200_001 - expected).max() < 0.004  # Kolmogorov-Smirnov, p = 0.003


def test_noise_differs_between_seeds_robots_and_steps():
    streams = [_normals(seed, robot, step, 2000) for seed in (1, 2) for robot in (0, 1) for step in (0, 1, 2)]
    streams += [stream[1:] for stream in streams[:1]]
    correlations = np.corrcoef([stream[:1999] for stream in streams]) - np.eye(len(streams))
    assert np.abs(correlations).max() < 0.12
    np.testing.assert_array_equal(streams[0], _normals(1, 0, 0, 2000))
