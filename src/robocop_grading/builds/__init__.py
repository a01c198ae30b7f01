"""Packages written by others: finds them, builds them in their own workspaces, and says what roslaunch would start."""
