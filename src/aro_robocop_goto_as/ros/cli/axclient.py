"""actionlib's graphical client axclient, in a window in which all of its fields can be seen."""

import argparse
import runpy
import sys
from typing import Any

import rosgraph
from roslib.packages import find_node

from ..names import ACTION, ACTION_TYPE, absolute

WIDTH, HEIGHT = 560, 780  # [pixel]


def main() -> None:
    """Open the window for the go-to server of a robot; it ends when the window is closed."""
    parser = argparse.ArgumentParser(prog="robocop axclient", description=__doc__)
    parser.add_argument("--robot", default="", help="name of one of several robots")
    args = parser.parse_args(rosgraph.myargv()[1:])
    import wx

    show = wx.Frame.Show

    def show_enlarged(frame: Any, *shown: bool) -> bool:
        room = wx.GetClientDisplayRect()
        frame.SetSize(min(WIDTH, room.width), min(HEIGHT, room.height))
        return bool(show(frame, *shown))

    wx.Frame.Show = show_enlarged  # axclient leaves its window at the smallest size
    (program,) = find_node("actionlib_tools", "axclient.py")[:1]
    sys.argv = [program, absolute(args.robot, ACTION), ACTION_TYPE]
    print("robocop axclient: change the numbers under Goal and press SEND GOAL; close the window to end it", flush=True)
    runpy.run_path(program, run_name="__main__")
