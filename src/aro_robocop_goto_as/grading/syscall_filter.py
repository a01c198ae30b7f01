"""Run as a program: start bubblewrap with a filter of the system calls with which memory can be hidden.

The guard counts what processes have mapped and open. System V shared memory, a tmpfs in a user namespace of the
submission's own, and a memfd that waits in a socket belong to no process, so these calls fail with EPERM.

Usage: python syscall_filter.py bwrap ARGUMENT...

It imports nothing of this package, because the environment of bubblewrap is bare.
"""

import errno
import os
import sys

DENIED = ("shmget", "memfd_create", "memfd_secret", "unshare", "setns")
NEW_USER = 0x10000000  # CLONE_NEWUSER of linux/sched.h


def filter_file() -> int:
    """Descriptor of a file with the filter as a BPF program, at its beginning, which a started program inherits."""
    import seccomp

    calls = seccomp.SyscallFilter(seccomp.ALLOW)
    for name in DENIED:
        calls.add_rule(seccomp.ERRNO(errno.EPERM), name)
    user = seccomp.Arg(0, seccomp.MASKED_EQ, NEW_USER, NEW_USER)
    calls.add_rule(seccomp.ERRNO(errno.EPERM), "clone", user)
    # A filter can't look at clone3's flags, which are in memory. ENOSYS makes the C library use clone.
    calls.add_rule(seccomp.ERRNO(errno.ENOSYS), "clone3")
    file = os.memfd_create("filter", 0)
    with os.fdopen(os.dup(file), "wb") as out:
        calls.export_bpf(out)
    os.lseek(file, 0, os.SEEK_SET)
    return file


def main() -> None:
    """Become bubblewrap."""
    program, *arguments = sys.argv[1:]
    os.execvp(program, [program, "--seccomp", str(filter_file()), *arguments])


if __name__ == "__main__":
    main()
