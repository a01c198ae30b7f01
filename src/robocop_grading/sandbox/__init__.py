"""What a hand-in may read, write and use up while it is built and run."""
