"""Errors shown to users. Subclasses differ by what the caller can do; programming errors: ValueError or TypeError."""

import re


class RobocopError(Exception):
    """Base of all errors that a user can meet."""

    @property
    def code(self) -> str:
        """The class's name as messages show it: ROBOT_MODEL for a RobotModelError."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", type(self).__name__)[: -len("_Error")].upper()


# -- The input is wrong: correct the file or parameter that the message names. --


class ParameterError(RobocopError):
    """A parameter is unknown, of the wrong type, or impossible."""


class WorldError(RobocopError):
    """A world, map or model file is missing, malformed, or contains something that is not supported."""


class RobotModelError(RobocopError):
    """A robot description lacks a link, joint or figure that the simulator needs."""


# -- A request is refused and nothing has changed: send another request. --


class FrameError(RobocopError):
    """A pose can't be transformed into the frame that is needed."""


class PlaceError(RobocopError):
    """A robot can't be placed at a pose, because something is there."""


class CommandError(RobocopError):
    """A velocity command contains NaN or infinity."""


# -- The system is ending, or the machine lacks something: nothing to correct in the request. --


class ShutdownError(RobocopError):
    """The simulation ended before a request was carried out."""


class ClockError(RobocopError):
    """Simulated time was set back, and a node can't go on."""


class InstallationError(RobocopError):
    """A part of this package is missing or of another version; the message says what to run."""


class MasterError(RobocopError):
    """The port of the ROS master is used by something that does not answer like a master."""


class TeleopError(RobocopError):
    """No robot can be driven from here; the message says what is missing."""


class WebError(RobocopError):
    """The web page can't be served at its address."""
