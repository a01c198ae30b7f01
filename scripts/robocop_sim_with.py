#!/usr/bin/env python3
"""Somebody's package against this simulator."""
from aro_robocop_goto_as.hosting.main import main

if __name__ == "__main__":
    main()
