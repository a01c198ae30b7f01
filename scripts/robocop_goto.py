#!/usr/bin/env python3
"""Send one goal from the command line; the exit status says how it ended."""
from aro_robocop_goto_as.nodes.goto_cli import main

if __name__ == "__main__":
    main()
