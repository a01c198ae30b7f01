"""Worlds: their model, reading them from files, editing them at run time, and poses for robots to start from."""
