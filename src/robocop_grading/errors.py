"""Errors of grading; the subclasses of GradingError say who can correct the cause."""

from aro_robocop_goto_as.errors import RobocopError


class GradingError(RobocopError):
    """A submission can't be graded; the subclasses say who can correct that."""


class PlanError(GradingError):
    """The grading plan is malformed; its author has to correct the file."""


class SubmissionError(GradingError):
    """A submission can't be read or built; its author has to correct it."""


class GradingSetupError(GradingError):
    """Something that grading needs is not installed or not running here; the person grading has to provide it."""


class UngradableError(GradingError):
    """The grader could not start its part of a run, or a run was ended from outside twice; runs can be repeated."""


class NoTimeError(UngradableError):
    """The machine has no time for a run; it can be repeated when the machine is less busy."""


class GraderLostError(GradingError):
    """The submission's node gives the grader answers that can't be true, so nothing that follows can be judged."""
