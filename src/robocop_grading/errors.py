"""Errors of grading; the subclasses of GradingError say who can correct the cause."""

from aro_robocop_goto_as.errors import RobocopError


class GradingError(RobocopError):
    """A submission can't be read, built or graded; subclasses and messages say who can correct that."""


class PlanError(GradingError):
    """The grading plan is malformed; its author has to correct the file."""


class GradingSetupError(GradingError):
    """Something that grading needs is not installed or not running here; the person grading has to provide it."""


class UngradableError(GradingError):
    """The machine has no time, no memory or nothing else for a run; the run can be repeated."""


class GraderLostError(GradingError):
    """The submission's node gives the grader answers that can't be true, so nothing that follows can be judged."""
