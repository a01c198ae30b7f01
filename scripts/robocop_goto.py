#!/usr/bin/env python3
"""Send one goal from the command line; the exit status says how it ended."""
import signal

for ending in (signal.SIGINT, signal.SIGTERM):
    signal.signal(ending, signal.SIG_DFL)  # until main() takes over: imports are long, and Ctrl-C is no traceback

from aro_robocop_goto_as.nodes.goto_cli import main  # noqa: E402

if __name__ == "__main__":
    main()
