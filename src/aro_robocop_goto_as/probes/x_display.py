"""The X server that DISPLAY names: whether it answers, and the size of its screen.

As a program it prints width and height, and its exit status is 0 if the server answers. It imports nothing of this
package, as ./robocop uses it before anything is installed.
"""

import ctypes
import os
import signal
import subprocess
import sys
from typing import Optional, Tuple

NO_XLIB = 3  # exit status
TIMEOUT = 5  # [s, wall] the alarm kills the program, which may be waiting inside Xlib


def screen_size() -> Optional[Tuple[int, int]]:
    """Width and height of the screen [pixel]; None if no X server answers."""
    if not os.environ.get("DISPLAY"):
        return None
    done = _look()
    if done.returncode != 0:
        return None
    width, height = done.stdout.split()
    return int(width), int(height)


def answers() -> bool:
    """Return whether windows can be opened; without Xlib, which RViz brings along, whether there is a DISPLAY."""
    return bool(os.environ.get("DISPLAY")) and _look().returncode in (0, NO_XLIB)


def _look() -> "subprocess.CompletedProcess[bytes]":
    return subprocess.run([sys.executable, "-IS", __file__], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)


def main() -> None:
    """Open the display, and print the size of its screen."""
    signal.alarm(TIMEOUT)
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        sys.exit(NO_XLIB)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        sys.exit(1)
    screen = x11.XDefaultScreen(display)
    print(x11.XDisplayWidth(display, screen), x11.XDisplayHeight(display, screen))


if __name__ == "__main__":
    main()
