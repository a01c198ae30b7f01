#!/usr/bin/env python3
"""The bridge from RViz's 2D Nav Goal to the go-to action server."""
from aro_robocop_goto_as.nodes.rviz_goto_ac import main

if __name__ == "__main__":
    main()
