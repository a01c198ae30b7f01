#!/usr/bin/env python3
"""Prints the URDF of the model that the simulator's parameter files choose."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.cli.description import main

if __name__ == "__main__":
    main()
