#!/usr/bin/env python3
"""Drive a robot with the keyboard."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.cli.teleop import main

if __name__ == "__main__":
    main()
