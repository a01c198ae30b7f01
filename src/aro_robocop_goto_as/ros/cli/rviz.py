"""RViz, configured for the running system; its warnings go to a log file where the terminal shows only what matters.

RViz looks for packages that export media, and rospack prints an error for each start because Debian has none; Qt and
OpenGL add warnings of their own.
"""

import argparse
import os
import sys
from pathlib import Path
from typing import Optional, Tuple

import numpy as np
import rosgraph
import roslib.packages
import rospkg
import rospy
import tf2_ros
from visualization_msgs.msg import MarkerArray

from ...geometry import Pose3D, rotation_matrix
from ...names import RVIZ_LOG, prefixed
from ...probes import x_display
from ..marker_shapes import MarkerStore, obstacles
from ..node_main import answer_help, leave_name_to_another
from ..share import share
from .rviz_config import Observed, adapted

ABOUT = "RViz, configured for the running system. Options that it does not have itself are passed on to RViz."
OPTIONS = "[--frame FIXED_FRAME] [--config FILE] [--wait SECONDS] [--trail]"
STDERR = 2  # file descriptor
# Runs until roslaunch ends it: a launch file ends with RViz, so RViz's node stays where there is no RViz.
IDLE = "setpriv --pdeathsig TERM -- sleep infinity".split()
WORLD_TOPIC = "/robocop_sim/world"
ODOM_TF = "/robocop_sim/odom_tf"  # parameter of the simulator
MESSAGE_TIMEOUT = 5.0  # [s, wall] for a latched message of a topic that is published
START_TIMEOUT = 1.0  # [s, wall] for map -> odom, which localization:=none does not publish
UNIT_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def main() -> None:
    """Replace this process by RViz, which is started again if it crashes."""
    answer_help(ABOUT, OPTIONS, others=True)
    parser = argparse.ArgumentParser(prog="robocop_rviz.py", add_help=False)
    parser.add_argument("--frame", default="map")
    parser.add_argument("--config", default="")  # empty: made for the system
    parser.add_argument("--wait", type=float, default=0.0)  # [s] for a simulator that is being started
    parser.add_argument("--trail", action="store_true")  # of odometry: no server is there that publishes one
    options, rest = parser.parse_known_args()
    if not x_display.answers():
        print("robocop: no usable display; RViz is not started", file=sys.stderr, flush=True)
        os.execvp("setpriv", IDLE)
    leave_name_to_another("rviz")
    seen = observe(options.frame, options.wait, not options.trail)
    config = options.config or _written(adapted(seen))
    (program,) = roslib.packages.find_node("rviz", "rviz")[:1] or ["rviz"]
    again = f"{share()}/launch/restart_after_crash"
    log = os.environ.get(RVIZ_LOG)
    if log:
        with open(log, "ab") as stream:
            os.dup2(stream.fileno(), STDERR)
    os.execv("/bin/bash", ["bash", again, program, "-d", config, "-f", options.frame, *rest])


def observe(frame: str, wait: float, server: bool) -> Observed:
    """Observe the system on ROS_MASTER_URI; wait up to `wait` [s] until the simulator has published its world."""
    screen = x_display.screen_size() or Observed.screen
    if not rosgraph.is_master_online():
        return Observed(frame, server=server, screen=screen)
    # Not under the name that RViz will have; on the wall clock, as simulated time may not run yet.
    rospy.init_node("robocop_rviz_config", argv=[], anonymous=True, disable_rostime=True, disable_signals=True)
    robot = rospy.get_namespace().strip("/")
    markers = _world(wait)
    seen = Observed(
        frame,
        robot,
        dict(rospy.get_published_topics()),
        description=rospy.search_param("robot_description") is not None,
        server=server,
        odom_tf=markers is None or bool(rospy.get_param(ODOM_TF, True)),
        obstacles=None if markers is None else corners_of(markers)[:, :2],
        start=(0.0, 0.0) if markers is None else _start(robot),
        screen=screen,
    )
    rospy.signal_shutdown("RViz starts")
    return seen


def _world(wait: float) -> Optional[MarkerArray]:
    """The markers of the simulator's world; None if they are not published within `wait` [s]."""
    if not wait and WORLD_TOPIC not in dict(rospy.get_published_topics()):
        return None
    try:
        return rospy.wait_for_message(WORLD_TOPIC, MarkerArray, max(wait, MESSAGE_TIMEOUT))
    except rospy.ROSException:
        return None


def corners_of(world: MarkerArray) -> np.ndarray:
    """Corners (n, 3) [m] of the boxes around the obstacles among the markers of the simulator's world."""
    store, corners = MarkerStore(), [np.zeros((0, 3))]
    store.apply(world)
    for shape, pose in obstacles(store.placed(lambda frame: Pose3D())):
        points = np.array(shape.points) if shape.points else UNIT_CORNERS * shape.size
        corners.append(points @ rotation_matrix(pose.orientation).T + pose.position)
    return np.vstack(corners)


def _start(robot: str) -> Tuple[float, float]:
    """Where the robot's odometry started, x, y [m] in map; the origin if that is unknown."""
    transforms = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(transforms)
    try:
        odom = prefixed(robot, "odom")
        found = transforms.lookup_transform("map", odom, rospy.Time(), rospy.Duration.from_sec(START_TIMEOUT))
    except tf2_ros.TransformException:
        return 0.0, 0.0
    finally:
        listener.unregister()
    return found.transform.translation.x, found.transform.translation.y


def _written(text: str) -> str:
    """Write the configuration to the folder of this run's logs; return its path, one for each namespace."""
    run_id = rospy.get_param("/run_id", "") if rosgraph.is_master_online() else ""
    folder = Path(rospkg.get_log_dir(), run_id)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"robocop{rosgraph.names.get_ros_namespace().rstrip('/').replace('/', '_')}.rviz"
    path.write_text(text, encoding="utf-8")
    return str(path)
