"""RViz as a node of a launch file: where there is no display it waits, and after a crash RViz is started again."""

import argparse
import os
import sys

import roslib.packages
from rosgraph.names import load_mappings

from ... import x_display
from ..node_main import answer_help, leave_name_to_another
from ..share import share

ABOUT = "RViz with one of rviz/*.rviz. Options that it does not have itself are passed on to RViz."
OPTIONS = "[--frame FIXED_FRAME] [--config FILE]"
STDERR = 2  # file descriptor
# Runs until roslaunch ends it: a launch file ends with RViz, so RViz's node stays where there is no RViz.
IDLE = "setpriv --pdeathsig TERM -- sleep infinity".split()


def main() -> None:
    """Replace this process by RViz, which is started again if it crashes."""
    answer_help(ABOUT, OPTIONS, others=True)
    parser = argparse.ArgumentParser(prog="robocop_rviz.py", add_help=False)
    parser.add_argument("--frame", default="map")
    parser.add_argument("--config", default="robocop.rviz")  # in rviz/, unless it is an absolute path
    options, rest = parser.parse_known_args()
    if not x_display.answers():
        print("robocop: no usable display; RViz is not started", file=sys.stderr, flush=True)
        os.execvp("setpriv", IDLE)
    leave_name_to_another("rviz")
    (program,) = roslib.packages.find_node("rviz", "rviz")[:1] or ["rviz"]
    again, config = f"{share()}/launch/restart_after_crash", os.path.join(share(), "rviz", options.config)
    log = load_mappings(sys.argv).get("__log")  # that roslaunch names
    if log:  # for warnings of Qt and rospack, which are there at each start
        with open(log, "ab") as stream:
            os.dup2(stream.fileno(), STDERR)
    os.execv("/bin/bash", ["bash", again, program, "-d", config, "-f", options.frame, *rest])
