"""Errors of grading; the subclasses of GradingError say who can correct the cause."""

from aro_robocop_goto_as.errors import RobocopError


class GradingError(RobocopError):
    """A submission can't be read, built or graded; subclasses and messages say who can correct that."""


class PlanError(GradingError):
    """The grading plan is malformed; its author has to correct the file."""


class GradingSetupError(GradingError):
    """Something that grading needs is not installed or not running here; the person grading has to provide it."""


class UngradableError(GradingError):
    """The grader can't start a run, has no time for it, or it was ended from outside twice; the run can be repeated."""


class GraderLostError(GradingError):
    """The submission's node gives the grader answers that can't be true, so nothing that follows can be judged."""
