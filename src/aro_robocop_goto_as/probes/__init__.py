"""Looks at the machine, with Python's standard library only, as ./robocop does before anything is installed."""
