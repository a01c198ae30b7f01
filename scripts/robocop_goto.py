#!/usr/bin/env python3
"""Send one goal from the command line; the exit status reports its result."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.cli.goto import main

if __name__ == "__main__":
    main()
