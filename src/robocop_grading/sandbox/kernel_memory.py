"""Memory that the kernel keeps for a process tree, beside what its processes have mapped.

What is counted can be told from /proc without any rights; the other calls that keep memory are refused by
syscall_filter.py.
"""

import contextlib
import functools
import os
import resource
import socket
from pathlib import Path
from typing import Dict, Iterator, Sequence

import psutil

# Variable with the number of the network outside of the sandboxes: that one's sockets are not the submission's.
OUTER_NETWORK = "ROBOCOP_OUTER_NETWORK"
ENTRY = 2048  # bytes of an empty file, some 1500 measured with Linux 6.18


def total(tree: Sequence["psutil.Process"], exact: bool) -> int:
    """Bytes of sockets and of entries of folders in memory; at least as many, but soon known, if not `exact`."""
    return _sockets(tree, exact) + _entries(tree)


def network_of(pid: object = "self") -> int:
    """The number of a process's network namespace."""
    return _namespace(pid, "net")


def _namespace(pid: object, kind: str) -> int:
    return os.stat(f"/proc/{pid}/ns/{kind}").st_ino


def _each(tree: Sequence["psutil.Process"], kind: str, outside: int) -> Iterator[int]:
    """The pid of one process in each namespace of a kind, without those in the namespace outside."""
    seen = {outside}
    for process in tree:
        with contextlib.suppress(OSError):  # the process has ended, or is another user's
            number = _namespace(process.pid, kind)
            if number not in seen:
                seen.add(number)
                yield process.pid


def _sockets(tree: Sequence["psutil.Process"], exact: bool) -> int:
    """Bytes that the sockets of the sandboxes' networks can hold, also those that no process has open any more.

    The kernel tells only what TCP holds, whose buffers grow. All others count with their full buffers, which have their
    default sizes (syscall_filter.py): 100 sockets, a usual number, count 40 MB. What TCP holds in all networks of the
    machine is one number (`mem` in sockstat, in pages); a network's own is in tables that take the kernel 10 ms.
    """
    size = 0
    for pid in _each(tree, "net", int(os.environ.get(OUTER_NETWORK, 0)) or network_of()):
        with contextlib.suppress(OSError):
            folder = Path(f"/proc/{pid}/net")
            words = (folder / "sockstat").read_text().split()
            size += int(words[2]) * _buffers()
            if exact:
                size += sum(_queued(folder / name) for name in ("tcp", "tcp6") if (folder / name).exists())
            else:
                size += int(words[words.index("mem") + 1]) * resource.getpagesize()
    return size


@functools.lru_cache(maxsize=None)
def _buffers() -> int:
    """Bytes of a socket's buffers."""
    with socket.socket(socket.AF_UNIX) as example:
        return sum(example.getsockopt(socket.SOL_SOCKET, option) for option in (socket.SO_SNDBUF, socket.SO_RCVBUF))


def _queued(table: Path) -> int:
    """Bytes in the queues of a table such as /proc/net/tcp."""
    queues = [line.split()[4].split(":") for line in table.read_text().splitlines()[1:]]
    return sum(int(number, 16) for queue in queues for number in queue)


def _entries(tree: Sequence["psutil.Process"]) -> int:
    """Bytes of the files and folders in the sandboxes' tmpfs; these limit their contents, but hardly their number."""
    used: Dict[int, int] = {}
    for pid in _each(tree, "mnt", _namespace("self", "mnt")):
        used.update(_tmpfs(pid))
    outside = _tmpfs("self") if used else {}
    return ENTRY * sum(number for device, number in used.items() if device not in outside)


def _tmpfs(pid: object) -> Dict[int, int]:
    """Device -> number of files and folders, of each tmpfs that a process sees."""
    used = {}
    with contextlib.suppress(OSError):
        for line in Path(f"/proc/{pid}/mounts").read_text(errors="replace").splitlines():
            _, place, kind, *_ = line.split()
            if kind == "tmpfs":
                with contextlib.suppress(OSError):
                    path = f"/proc/{pid}/root{place}"
                    status = os.statvfs(path)
                    used[os.stat(path).st_dev] = status.f_files - status.f_ffree
    return used
