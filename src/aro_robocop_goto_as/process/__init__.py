"""Operating system processes: how programs start, signals, locks of files."""
