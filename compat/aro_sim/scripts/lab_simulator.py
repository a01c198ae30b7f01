#!/usr/bin/env python3
"""Replaces itself by the simulator's roslaunch. Arguments: those of the launch file, `--`, Gazebo's spawn_model ones.

A package in this workspace may have the same name as the simulator's package. If ROBOCOP_WS names the workspace in
which the simulator was built, the simulator runs in that workspace's environment, otherwise in this one's.
"""

import argparse
import os
import shlex
import sys

SHADOWING = ("PYTHONPATH", "CMAKE_PREFIX_PATH", "ROS_PACKAGE_PATH")  # would resolve to this workspace first


def spawn_from(words):
    """spawn_model's arguments -> the simulator's spawn argument; without any, the world's own spawn pose."""
    parser = argparse.ArgumentParser(prog="aro_sim: spawn_args", allow_abbrev=False)
    for option in ("-x", "-y", "-z", "-R", "-P", "-Y"):
        parser.add_argument(option, type=float, default=0.0)
    pose = parser.parse_args(words)
    return [f"spawn:={pose.x} {pose.y} {pose.Y}"] if words else []


def main():
    """Never returns: the process becomes roslaunch, so that ending this node ends the simulator."""
    words = [word for word in sys.argv[1:] if not word.startswith("__")]  # ROS's own remappings
    args, spawn_args = words[: words.index("--")], words[words.index("--") + 1 :]
    args += ["cmd_vel_timeout:=0.0", "odom_tf:=false", "moving:=true", "gazebo_services:=true"] + spawn_from(spawn_args)
    args += shlex.split(os.environ.get("ROBOCOP_SIM_ARGS", ""))
    workspace = os.environ.get("ROBOCOP_WS")
    # Not plain roslaunch, whose exit status does not report how the simulator ended.
    launch = (
        [f"{workspace}/lib/aro_robocop_goto_as/robocop_launch.py"]
        if workspace
        else ["rosrun", "aro_robocop_goto_as", "robocop_launch.py"]
    )
    command = [*launch, "--no-summary", "aro_robocop_goto_as", "robocop_sim.launch", *args]
    if not workspace:
        os.execvp(command[0], command)
    types = [path for path in os.environ.get("PYTHONPATH", "").split(":") if "/compat/" in path]  # gazebo_msgs
    for name in SHADOWING:
        os.environ.pop(name, None)
    os.execvp(
        "bash",
        [
            "bash",
            "-c",
            '. "$0/setup.bash"; export PYTHONPATH=$PYTHONPATH:$1; shift; exec "$@"',
            workspace,
            ":".join(types),
            *command,
        ],
    )


if __name__ == "__main__":
    main()
