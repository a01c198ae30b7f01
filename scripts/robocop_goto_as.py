#!/usr/bin/env python3
"""The go-to action server."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.server.node import main

if __name__ == "__main__":
    main()
