"""Operating system processes: starting and ending children, signals, orphaned descendants, free ports."""
