#!/usr/bin/env python3
"""Somebody's server and bridge, judged."""
from aro_robocop_goto_as.grading.main import main

if __name__ == "__main__":
    main()
