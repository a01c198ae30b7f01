#!/usr/bin/env python3
"""roslaunch with an exit status that reports how the simulator ended."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.cli.launch import main

if __name__ == "__main__":
    main()
