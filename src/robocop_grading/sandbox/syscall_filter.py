"""Run as a program: start bubblewrap with system calls that a submission may not use.

The guard counts the memory that processes have mapped. What can take memory that counts as no process's is refused: a
call fails with ENOSYS, as on a kernel that does not have it, and programs fall back as they do on such a kernel.
Calls of another architecture, such as 32-bit calls on x86-64, kill the process.

Usage: python syscall_filter.py bwrap ARGUMENT...

In ARGUMENT..., bwrap's option --ro-bind-data is followed by a text in place of a descriptor.

It imports nothing of this package, because the environment of bubblewrap is bare.
"""

import contextlib
import errno
import os
import socket
import sys
from functools import partial
from typing import Any, Callable, Iterator, List, Sequence, Tuple

# Memory in System V IPC, queues, memfds, io_uring, keys, pipes and watches; other processes' memory; new namespaces.
# clone3's flags are in memory, where a filter can't look at them; without it the C library uses clone.
REFUSED = """
semget msgget shmget mq_open memfd_create memfd_secret io_uring_setup add_key request_key keyctl splice tee vmsplice
inotify_init inotify_init1 fanotify_init bpf perf_event_open userfaultfd ptrace process_vm_readv process_vm_writev
clone3 unshare setns
""".split()
# They have no effect: a node that others overtake could take hours, and then has no grade.
PRIORITIES = "ioprio_set sched_setattr sched_setparam sched_setscheduler setpriority".split()
FAMILIES = (socket.AF_UNIX, socket.AF_INET, socket.AF_INET6, socket.AF_NETLINK)
BUFFER_SIZES = (socket.SO_SNDBUF, socket.SO_RCVBUF)
NAMESPACES = (0x20000, *(1 << bit for bit in range(25, 31)))  # the CLONE_NEW... flags of linux/sched.h
SHARED_ANONYMOUS = 0x21  # MAP_SHARED and MAP_ANONYMOUS of mmap
INT = 0xFFFFFFFF  # the part of a register that the kernel reads of an int

Rule = Tuple[Any, ...]  # action, name of a call, conditions that all have to hold


def rules() -> Iterator[Rule]:
    """What is not allowed; a call for which no rule holds is."""
    from seccomp import ERRNO, GT, MASKED_EQ, Arg

    missing, other_family = ERRNO(errno.ENOSYS), ERRNO(errno.EAFNOSUPPORT)
    for name in REFUSED:
        yield missing, name
    for name in PRIORITIES:
        yield ERRNO(0), name
    for flag in NAMESPACES:
        yield missing, "clone", Arg(0, MASKED_EQ, flag, flag)
    for name in ("mmap", "mmap2"):  # such memory outlives a partial unmap, and is then charged to nobody
        yield missing, name, Arg(3, MASKED_EQ, SHARED_ANONYMOUS, SHARED_ANONYMOUS)
    for family in {*range(max(FAMILIES))} - {*FAMILIES}:
        yield other_family, "socket", Arg(0, MASKED_EQ, INT, family)
    yield other_family, "socket", Arg(0, GT, max(FAMILIES))
    # The kernel refuses no size of a buffer; here the size stays, so that the number of sockets limits what they hold.
    for option in BUFFER_SIZES:
        level = Arg(1, MASKED_EQ, INT, socket.SOL_SOCKET)
        yield ERRNO(0), "setsockopt", level, Arg(2, MASKED_EQ, INT, option)


def filter_file() -> int:
    """Descriptor of a file with the filter as a BPF program."""
    import seccomp

    calls = seccomp.SyscallFilter(seccomp.ALLOW)
    for action, name, *conditions in rules():
        if seccomp.resolve_syscall(seccomp.Arch(), name) != -1:  # newer than this libseccomp
            calls.add_rule(action, name, *conditions)
    return memory_file(calls.export_bpf)


def memory_file(write: Callable[[Any], object]) -> int:
    """Descriptor of a file with what `write` writes to it, at its beginning, which a started program inherits."""
    file = os.memfd_create("sandbox", 0)
    with os.fdopen(os.dup(file), "wb") as out:
        write(out)
    os.lseek(file, 0, os.SEEK_SET)
    return file


def with_descriptors(arguments: Sequence[str]) -> List[str]:
    """bwrap's arguments, each text in place of a descriptor as a file."""
    words, option = [], ""
    for word in arguments:
        words.append(str(memory_file(partial(_write, word))) if option == "--ro-bind-data" else word)
        option = word if option != "--" else option
    return words


def _write(text: str, file: Any) -> None:
    file.write(text.encode(errors="surrogateescape"))


def main() -> None:
    """Become bubblewrap, and a process that the kernel kills before the grader if memory runs out."""
    with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w") as file:
        file.write("1000")
    program, *arguments = sys.argv[1:]
    arguments = with_descriptors(arguments)
    os.execvp(program, [program, "--seccomp", str(filter_file()), *arguments])


if __name__ == "__main__":
    main()
