"""robocop sim --with PATH: launches a hosted package and the simulator in this process."""

import os

from aro_robocop_goto_as.ros.cli import launch

from .main import parsed, prepare


def main() -> None:
    """Build and launch what the arguments name; ending this process ends everything."""
    args = parsed()
    path, environment = prepare(args)
    # Not in a new process: in the hosted package's environment this package might not be found.
    os.environ.clear()
    os.environ.update(environment)
    launch.main([*([] if args.verbose else ["--no-summary"]), "--overview", str(path)])
