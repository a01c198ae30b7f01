#!/usr/bin/env python3
"""The web page that shows the system in a browser."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback if Ctrl-C interrupts the imports; main() handles it

from aro_robocop_goto_as.ros.web.node import main  # noqa: E402

if __name__ == "__main__":
    main()
