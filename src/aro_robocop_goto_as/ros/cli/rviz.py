"""RViz, configured for the running system; its warnings go to a log file where the terminal shows only what matters.

RViz looks for packages that export media, and rospack prints an error for each start because Debian has none; Qt and
OpenGL add warnings of their own.
"""

import argparse
import os
from typing import List, Optional

import rosgraph
import roslib.packages
import rospkg

from ...rviz.config import robocop
from .rviz_scene import scene_of

PACKAGE = "aro_robocop_goto_as"
LOG = "ROBOCOP_RVIZ_LOG"  # environment variable: the file; without it RViz writes to the terminal
STDERR = 2  # file descriptor


def main(arguments: Optional[List[str]] = None) -> None:
    """Replace this process by RViz, which is started again if it crashes."""
    parser = argparse.ArgumentParser(prog="robocop_rviz.py", description=__doc__)
    parser.add_argument("--frame", default="map", help="RViz's Fixed Frame (default map)")
    parser.add_argument("--config", default="", help="a configuration file of your own; empty: one is generated")
    parser.add_argument("--wait", type=float, default=0.0, help="[s] for a simulator that is being started (default 0)")
    parser.add_argument("--server", action="store_true", help="also show the markers of the go-to server")
    options, rest = parser.parse_known_args(arguments)
    config = options.config or _generated(options.frame, options.wait, options.server)
    (program,) = roslib.packages.find_node("rviz", "rviz")[:1] or ["rviz"]
    again = os.path.join(rospkg.RosPack().get_path(PACKAGE), "launch", "restart_after_crash")
    log = os.environ.get(LOG)
    if log:
        with open(log, "ab") as stream:
            os.dup2(stream.fileno(), STDERR)
    os.execv(again, [again, program, "-d", config, "-f", options.frame, *rest])


def _generated(frame: str, wait: float, server: bool) -> str:
    """Write the configuration to the folder of this run's logs; its path, one for each namespace."""
    text = robocop(scene_of(frame, wait, server))
    robot = rosgraph.names.get_ros_namespace().strip("/").replace("/", "_")
    folder = os.path.join(rospkg.get_log_dir(), _run_id())
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, f"robocop_{robot}.rviz" if robot else "robocop.rviz")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def _run_id() -> str:
    """Of the ROS master; empty if it does not answer."""
    try:
        return str(rosgraph.Master("/robocop_rviz").getParam("/run_id"))
    except (rosgraph.MasterException, OSError):
        return ""
