#!/usr/bin/env python3
"""actionlib's graphical client for the go-to action server."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback if Ctrl-C interrupts the imports
signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # ./robocop blocks it while Python starts

from aro_robocop_goto_as.ros.cli.axclient import main  # noqa: E402

if __name__ == "__main__":
    main()
