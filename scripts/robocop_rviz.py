#!/usr/bin/env python3
"""RViz, with its warnings in a log file."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback if Ctrl-C interrupts the imports; RViz handles it

from aro_robocop_goto_as.ros.cli.rviz import main  # noqa: E402

if __name__ == "__main__":
    main()
