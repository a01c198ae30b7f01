"""Limits what a hand-in can read, write and use up while it is built and run."""
