"""The arguments of robocop goto, and what its parts share. It imports nothing of ROS."""

import argparse
import math
import re
import sys
from typing import List

from ...param_loading import MAX_COORDINATE
from ...process.start import typed

SERVER_TIMEOUT = 5.0  # [s, wall] for the server, and for the transform of the goal
REACHED, NOT_REACHED = 0, 1  # exit statuses; 2 for wrong arguments is argparse's own
NEGATIVE = re.compile(r"-[\d.]+([eE][-+]?\d+)?")
DEFAULT_FRAME = "map"  # in which RViz gives its 2D Nav Goals


def parse(argv: List[str]) -> argparse.Namespace:
    """The arguments; ends the program with exit status 2 if they are wrong."""
    parser = argparse.ArgumentParser(
        prog=typed("goto"),
        description="Send one goal and follow it to its end.",
        usage="%(prog)s X Y [--frame F] [--robot NAME]",
        epilog="Needs a running system, such as that of `robocop run`. Exit status 0 if the goal is reached, 1 if not, "
        "2 for wrong arguments.",
    )
    parser.add_argument("x", type=_metres, help="[m]")
    parser.add_argument("y", type=_metres, help="[m]")
    parser.add_argument(
        "--frame",
        default=DEFAULT_FRAME,
        help="of X and Y: map (default; as a click in RViz), odom, base_footprint (relative to the robot), ...",
    )
    parser.add_argument("--robot", default="", help="name of one of several robots; frames are given without it")
    # argparse takes -5e-1 for an option, but not with a space before it.
    args = parser.parse_args([f" {word}" if NEGATIVE.fullmatch(word) else word for word in argv])
    if not args.frame:
        parser.error("--frame: expected the name of a frame, got nothing")
    return args


def _metres(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= MAX_COORDINATE:  # true for NaN
        raise argparse.ArgumentTypeError(
            f"expected a number of metres within +-{MAX_COORDINATE:g}, got {text.strip()!r}"
        )
    return value


def tell(text: str) -> None:
    """Print a line to standard output."""
    print(text, flush=True)


def complain(text: str) -> None:
    """Print a message to standard error."""
    print(f"robocop goto: {text}", file=sys.stderr, flush=True)
