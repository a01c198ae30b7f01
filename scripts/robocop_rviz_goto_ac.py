#!/usr/bin/env python3
"""The bridge from RViz's 2D Nav Goal to the go-to action server."""
import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() takes over: imports are long, and Ctrl-C is no traceback

from aro_robocop_goto_as.nodes.rviz_goto_ac import main  # noqa: E402

if __name__ == "__main__":
    main()
