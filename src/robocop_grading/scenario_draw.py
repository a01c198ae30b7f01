"""Numbers of a plan that are drawn from ranges, LOW..HIGH, with the plan's seed."""

import random
import re
from typing import Any

from aro_robocop_goto_as.errors import PlanError

MIDDLE = 0  # the seed with which every range stands for its middle
LARGEST_SEED = 999_999
DIGITS = 3  # of a drawn number after the point: [mm], [mrad], [ms]
_NUMBER = r"-?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})", re.ASCII)


def checked_seed(seed: int) -> int:
    """The seed; PlanError if it is out of bounds."""
    if not MIDDLE <= seed <= LARGEST_SEED:
        raise PlanError(f"--seed {seed}: expected a number from {MIDDLE} to {LARGEST_SEED}")
    return seed


class Draw:
    """The numbers of one scenario: the same for one seed, whatever the other scenarios are."""

    def __init__(self, seed: int, scenario: str) -> None:
        self._random = None if seed == MIDDLE else random.Random(f"{seed}/{scenario}")

    def number(self, value: Any, where: str) -> Any:
        """A number of the range if `value` is one, otherwise `value`; PlanError if the range is empty."""
        match = _RANGE.fullmatch(value) if isinstance(value, str) else None
        if match is None:
            return value
        low, high = map(float, match.groups())
        if low > high:
            raise PlanError(f"{where}: {value}: expected LOW..HIGH, with LOW not above HIGH")
        drawn = (low + high) / 2.0 if self._random is None else self._random.uniform(low, high)
        return round(drawn, DIGITS)
