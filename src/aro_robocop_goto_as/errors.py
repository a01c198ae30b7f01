"""Every error this package raises, each with a code that scripts may rely on."""


class RobocopError(Exception):
    """Base of all errors a user can meet; `code` stays the same from release to release."""

    code = "ROBOCOP"


class ParameterError(RobocopError):
    """A parameter is unknown, of the wrong type, or impossible."""

    code = "PARAMETER"


class WorldError(RobocopError):
    """A world file is missing, malformed, or asks for something that can't be honoured."""

    code = "WORLD"


class RobotModelError(RobocopError):
    """A robot description lacks a link, joint or figure that the simulator needs."""

    code = "ROBOT_MODEL"


class FrameError(RobocopError):
    """A pose can't be expressed in the frame that is asked for."""

    code = "FRAME"


class CommandError(RobocopError):
    """A velocity command holds NaN or infinity."""

    code = "COMMAND"


class BenchError(RobocopError):
    """A measurement can't be made."""

    code = "BENCH"


class HostingError(RobocopError):
    """Somebody's package can't be found, built or started."""

    code = "HOSTING"


class GradingError(RobocopError):
    """A submission can't be graded, or the plan of the grading is malformed."""

    code = "GRADING"
