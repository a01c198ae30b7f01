#!/usr/bin/env python3
"""Run another package with this simulator."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from robocop_hosting.sim_with import main

if __name__ == "__main__":
    main()
