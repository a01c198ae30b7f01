"""Repeatable noise of slip, IMU and number of beams, by seed, stream and step only; ranges draw theirs in lidar.c."""

import numpy as np


class NoiseStreams:
    """One generator, set to the beginning of a stream on a step.

    A new Philox for each would read entropy from the system, which costs more than the noise.
    """

    def __init__(self) -> None:
        self._generator = np.random.Generator(np.random.Philox(0))
        self._state = self._generator.bit_generator.state

    def at(self, seed: int, stream: int, step: int) -> np.random.Generator:
        """The generator at the beginning of a stream on a step; valid until the next call."""
        self._generator.bit_generator.state = {
            **self._state,
            "state": {
                "counter": np.array([0, 0, 0, step], np.uint64),
                "key": np.array([seed, stream], np.uint64),
            },
        }
        return self._generator
