#!/usr/bin/env python3
"""Measure the simulator's speed and print a table."""

from aro_robocop_goto_as.bench.main import main

if __name__ == "__main__":
    main()
