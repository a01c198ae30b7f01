"""One function per contract of the handout, over one scenario's record: passed, failed, or not reached."""

from . import bridge, endings, feedback, life, motion  # noqa: F401  each registers its checks
from .verdict import CHECKS, PLOTS, Check, Failed, NotReached, Passed, Verdict, sentence

__all__ = ["CHECKS", "PLOTS", "Check", "Failed", "NotReached", "Passed", "Verdict", "sentence"]
