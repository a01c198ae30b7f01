"""Locks of open files, also on a disk that has none."""

import fcntl
import sys


def lock(descriptor: int, operation: int) -> bool:
    """Lock an open file by fcntl.flock(); return whether no other process holds it, for an operation with LOCK_NB.

    A disk without locks, such as an NFS home, counts as free, with a line that says so.
    """
    try:
        fcntl.flock(descriptor, operation)
    except BlockingIOError:
        return False
    except OSError as error:  # ENOLCK, or whatever else a file system says
        print(f"robocop: no file can be locked on this disk ({error.strerror}): going on without", file=sys.stderr)
    return True
