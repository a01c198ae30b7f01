#!/usr/bin/env python3
"""The simulator node."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.sim.node import main

if __name__ == "__main__":
    main()
