"""Looks at the machine, with Python's standard library only, because ./robocop does so before anything is installed."""
