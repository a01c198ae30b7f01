#!/usr/bin/env python3
"""Grade the submissions of a class."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from robocop_grading.classroom.main import main

if __name__ == "__main__":
    main()
