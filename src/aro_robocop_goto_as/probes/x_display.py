"""Whether the X server that DISPLAY names answers.

As a program its exit status is 0 if the server answers. It imports nothing of this package, as ./robocop uses it before
anything is installed.
"""

import ctypes
import os
import signal
import subprocess
import sys

NO_XLIB = 3  # exit status
TIMEOUT = 5  # [s, wall] the alarm kills the program, which may be waiting inside Xlib


def answers() -> bool:
    """Return whether windows can be opened; without Xlib, which RViz brings along, whether there is a DISPLAY."""
    if not os.environ.get("DISPLAY"):
        return False
    return subprocess.call([sys.executable, "-IS", __file__], stderr=subprocess.DEVNULL) in (0, NO_XLIB)


def main() -> None:
    """Open the display."""
    signal.alarm(TIMEOUT)
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        sys.exit(NO_XLIB)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    sys.exit(0 if x11.XOpenDisplay(None) else 1)


if __name__ == "__main__":
    main()
