#!/usr/bin/env python3
"""Create the lab's skeleton package, with its TODOs."""

from aro_robocop_goto_as.process.start import imports

with imports():
    from robocop_grading.new import main

if __name__ == "__main__":
    main()
