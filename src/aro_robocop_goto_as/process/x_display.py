"""A program whose exit status is 0 if the X server that DISPLAY names answers.

It imports nothing of this package, as ./robocop runs it before anything is installed.
"""

import ctypes
import signal
import sys

TIMEOUT = 5  # [s, wall] the alarm kills this program, which may be waiting inside Xlib


def main() -> None:
    """Try to open the display."""
    signal.alarm(TIMEOUT)
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    sys.exit(not x11.XOpenDisplay(None))


if __name__ == "__main__":
    main()
