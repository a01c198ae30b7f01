#!/usr/bin/env python3
"""Prints the URDF of the model that the simulator's parameter files choose."""

import gc
import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback if Ctrl-C interrupts the imports; main() handles it
signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # ./robocop blocks it while Python starts
gc.disable()  # collections would go through all that the imports create

from aro_robocop_goto_as.ros.cli.description import main  # noqa: E402

gc.freeze()  # what they created is here to stay
gc.enable()

if __name__ == "__main__":
    main()
