#!/usr/bin/env python3
"""The go-to action server."""
from aro_robocop_goto_as.nodes.goto_as import main

if __name__ == "__main__":
    main()
