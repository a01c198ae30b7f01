"""Errors of finding, building and starting somebody else's package."""

from aro_robocop_goto_as.errors import RobocopError


class HostingError(RobocopError):
    """A package can't be found, built or started."""
