#!/usr/bin/env python3
"""How fast the simulator is, as one table."""
from aro_robocop_goto_as.bench.main import main

if __name__ == "__main__":
    main()
