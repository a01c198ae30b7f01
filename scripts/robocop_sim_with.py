#!/usr/bin/env python3
"""Somebody's package against this simulator."""
from aro_robocop_goto_as.nodes.launch import main_with

if __name__ == "__main__":
    main_with()
