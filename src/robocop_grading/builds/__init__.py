"""Packages written by others: found, built in a workspace of their own, and what roslaunch would start of them."""
