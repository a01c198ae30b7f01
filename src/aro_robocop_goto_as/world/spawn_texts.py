"""Parse the texts of the parameters that say where robots start."""

from typing import List, NamedTuple

from ..errors import ParameterError
from ..geometry import MAX_COORDINATE, Pose2D

MAX_COUNT = 1000  # of robots: more than any machine simulates, yet few enough to look for room for them


class SpawnRequest(NamedTuple):
    """One entry of a list of robots; model: its name, empty if the entry gives none."""

    name: str
    model: str
    pose: Pose2D


def parse_spawn(text: str, default: Pose2D, parameter: str = "spawn") -> Pose2D:
    """A pose from 'x y' or 'x y yaw' [m, rad]; the default for a blank text. ParameterError names the parameter."""
    if not text.strip():
        return default
    try:
        numbers = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(abs(number) <= MAX_COORDINATE for number in numbers):
        raise ParameterError(
            f"{parameter}: expected 'x y' or 'x y yaw' in metres and radians, numbers within "
            f"+-{MAX_COORDINATE:g}, got {text!r}"
        )
    return Pose2D(*numbers)


def parse_count(text: str) -> int:
    """The number of robots in a text of digits; ParameterError if there are none or more than MAX_COUNT."""
    count = int(text) if len(text) <= len(str(MAX_COUNT)) else MAX_COUNT + 1
    if not 1 <= count <= MAX_COUNT:
        raise ParameterError(f"robots: expected a number from 1 to {MAX_COUNT}, got {text[:20]}")
    return count


def parse_robots(text: str) -> List[SpawnRequest]:
    """The entries of 'NAME[:MODEL] X Y [YAW]; ...' [m, rad]; ParameterError quotes the entry that is wrong."""
    requests: List[SpawnRequest] = []
    for entry in (part.strip() for part in text.strip(" ;").split(";")):
        head, _, pose = entry.partition(" ")
        name, colon, model = head.partition(":")
        if not (name.isidentifier() and name.isascii()) or bool(colon) != bool(model) or not pose.strip():
            raise ParameterError(
                f"robots: expected a number, such as 3, or 'NAME X Y [YAW]; ...' or 'NAME:MODEL X Y [YAW]; ...' with "
                f"names of letters, digits and _, got {entry!r}"
            )
        if name in [request.name for request in requests]:
            raise ParameterError(f"robots: the name {name!r} is given twice")
        requests.append(SpawnRequest(name, model, parse_spawn(pose, Pose2D(), f"robots: {name}")))
    return requests
