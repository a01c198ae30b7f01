"""Whether the X server that DISPLAY names answers.

As a program it exits with 0 if the server answers. It imports nothing of this package, as ./robocop uses it before
anything is installed.
"""

import ctypes
import os
import signal
import subprocess
import sys

TIMEOUT = 5  # [s, wall] the alarm kills the program, which may be waiting inside Xlib
NO_SERVER, NO_XLIB = 1, 3  # exit statuses


def answers() -> bool:
    """Return whether windows can be opened; without Xlib, which RViz brings along, whether there is a DISPLAY."""
    if not os.environ.get("DISPLAY"):
        return False
    done = subprocess.run([sys.executable, "-IS", __file__], stderr=subprocess.DEVNULL)
    return done.returncode in (0, NO_XLIB)


def main() -> None:
    """Open the display."""
    signal.alarm(TIMEOUT)
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        sys.exit(NO_XLIB)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    sys.exit(0 if x11.XOpenDisplay(None) else NO_SERVER)


if __name__ == "__main__":
    main()
