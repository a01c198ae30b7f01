"""Repeatable noise of slip, IMU and number of beams, by seed, stream and step; lidar.c draws the noise of ranges."""

import ctypes

import numpy as np


class Episode(ctypes.Structure):
    """What all noise depends on; `struct episode` of lidar.c.

    seed: of this episode, which begins at a reset
    step: steps since its beginning
    """

    _fields_ = [("seed", ctypes.c_uint64), ("step", ctypes.c_uint64)]
    seed: int
    step: int


class NoiseStreams:
    """One generator, set to the beginning of a stream on the present step.

    A new Philox for each stream would read entropy from the system, which costs more than the noise.
    """

    def __init__(self, episode: Episode) -> None:
        self._episode = episode
        self._generator = np.random.Generator(np.random.Philox(0))
        self._state = self._generator.bit_generator.state

    def stream(self, number: int) -> np.random.Generator:
        """The generator at the beginning of a stream on this step; valid until the next call."""
        self._generator.bit_generator.state = {
            **self._state,
            "state": {
                "counter": np.array([0, 0, 0, self._episode.step], np.uint64),
                "key": np.array([self._episode.seed, number], np.uint64),
            },
        }
        return self._generator
