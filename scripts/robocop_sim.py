#!/usr/bin/env python3
"""The simulator node."""
from aro_robocop_goto_as.nodes.sim import main

if __name__ == "__main__":
    main()
