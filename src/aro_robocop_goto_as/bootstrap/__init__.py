"""What runs before anything is installed, with Python's standard library only."""
