"""What ./robocop runs with the bare /usr/bin/python3, before anything is installed: standard library only."""
