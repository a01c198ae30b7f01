"""Builds what the first grading would build: the lab's action and the packages of compat/."""

import sys

from aro_robocop_goto_as.errors import RobocopError

from .hosting.places import places
from .submission import lab_environment


def main() -> None:
    """Exit status 1 if the build fails."""
    try:
        state, share = places()
        lab_environment(share, state)
    except RobocopError as error:
        sys.exit(f"robocop setup: {error}")


if __name__ == "__main__":
    main()
