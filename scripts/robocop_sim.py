#!/usr/bin/env python3
"""The simulator node."""
import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() takes over: imports are long, and Ctrl-C is no traceback

from aro_robocop_goto_as.nodes.sim import main  # noqa: E402

if __name__ == "__main__":
    main()
