"""The commands of ./robocop. `commands`, and what it imports, runs before anything is installed."""
