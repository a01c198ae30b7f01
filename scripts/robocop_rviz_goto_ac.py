#!/usr/bin/env python3
"""The bridge from RViz's 2D Nav Goal to the go-to action server."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.client.rviz_bridge import main

if __name__ == "__main__":
    main()
