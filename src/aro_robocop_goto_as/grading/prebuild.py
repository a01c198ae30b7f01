"""Builds what the first grading would build: the lab's action and the packages of compat/."""

import os
import sys
from pathlib import Path

from ..errors import RobocopError
from .submission import lab_environment


def main() -> None:
    """Exit status 1 if the build fails."""
    try:
        lab_environment(Path(os.environ["ROBOCOP_SHARE"]), Path(os.environ["ROBOCOP_STATE"]))
    except RobocopError as error:
        sys.exit(f"robocop setup: {error}")


if __name__ == "__main__":
    main()
