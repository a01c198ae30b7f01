"""The contracts of the handout, one check function each: a scenario's record -> passed, failed or not reached."""

from . import bridge, endings, feedback, motion, node_lifetime, obstacles, preemption  # noqa: F401  they register their checks
from .verdict import CHECKS, PASSED, Failed, NotReached, Passed, Verdict

__all__ = ["CHECKS", "PASSED", "Failed", "NotReached", "Passed", "Verdict"]
