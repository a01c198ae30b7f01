"""Operating system processes: how programs start, children, signals, orphaned descendants, free ports."""
