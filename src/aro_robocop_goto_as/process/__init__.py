"""Operating system processes: how programs start, and signals."""
