"""RViz, whose warnings go to a log file where the terminal is to show only what matters.

RViz looks for packages that export media, and rospack prints an error for each start because Debian has none; Qt and
OpenGL add warnings of their own.
"""

import os
import sys

import roslib.packages

LOG = "ROBOCOP_RVIZ_LOG"  # environment variable: the file; without it RViz writes to the terminal
STDERR = 2  # file descriptor


def main() -> None:
    """Replace this process by RViz, with the same arguments."""
    (program,) = roslib.packages.find_node("rviz", "rviz")[:1] or ["rviz"]
    log = os.environ.get(LOG)
    if log:
        with open(log, "ab") as stream:
            os.dup2(stream.fileno(), STDERR)
    os.execvp(program, [program, *sys.argv[1:]])
