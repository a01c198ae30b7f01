#!/usr/bin/env python3
"""RViz, with its warnings in a log file."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.cli.rviz import main

if __name__ == "__main__":
    main()
