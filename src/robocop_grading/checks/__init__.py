"""The contracts of the handout, one check function each: a scenario's record -> passed, failed or not reached."""

from . import arriving, bridge, endings, feedback, node_lifetime, obstacles, preemption, turning  # noqa: F401  they register their checks
from .verdict import CHECKS, PASSED, Failed, NotReached, Passed, Verdict

__all__ = ["CHECKS", "PASSED", "Failed", "NotReached", "Passed", "Verdict"]
