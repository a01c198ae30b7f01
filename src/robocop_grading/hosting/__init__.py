"""Packages written by others: found, built in a workspace of their own, run against this simulator."""
