"""Processes, found by what they were started with: this machine's own account of what is left running."""

from pathlib import Path


def processes_with(setting, word=b""):
    """Ids of processes with `setting`, bytes NAME=value, in their environment, and `word` on their command line."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            settings, command = (process / "environ").read_bytes().split(b"\0"), (process / "cmdline").read_bytes()
            if setting in settings and word in command:
                found.append(int(process.name))
        except OSError:  # ended meanwhile, or somebody else's
            continue
    return found
