#!/usr/bin/env python3
"""roslaunch with an exit status that tells how the simulator ended."""
from aro_robocop_goto_as.nodes.launch import main

if __name__ == "__main__":
    main()
