#!/usr/bin/env python3
"""`./robocop bench`: this folder is on the path of a script that is in it."""

import sys

from bench.main import main

if __name__ == "__main__":
    sys.exit(main())
