#!/usr/bin/env python3
"""Grade one submission: its action server and its bridge."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from robocop_grading.cli import main

if __name__ == "__main__":
    main()
