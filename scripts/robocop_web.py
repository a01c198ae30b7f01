#!/usr/bin/env python3
"""The web page that shows the system in a browser."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from aro_robocop_goto_as.ros.web.node import main

if __name__ == "__main__":
    main()
