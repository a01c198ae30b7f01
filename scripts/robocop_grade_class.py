#!/usr/bin/env python3
"""Everybody's server and bridge, judged."""
from aro_robocop_goto_as.grading.classroom.main import main

if __name__ == "__main__":
    main()
