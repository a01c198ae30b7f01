"""The processes below a process, as /proc lists them."""

import contextlib
import glob
from typing import Iterator, List


def children_of(pid: int) -> List[int]:
    """Process ids; none where the kernel does not list them."""
    return [int(word) for words in words_of(f"/proc/{pid}/task/*/children") for word in words]


def descendants_of(pid: int) -> Iterator[int]:
    """Process ids, parents before their children."""
    waiting = children_of(pid)
    while waiting:
        process = waiting.pop(0)
        yield process
        waiting += children_of(process)


def words_of(pattern: str) -> Iterator[List[str]]:
    """The words of each of these files, from behind a name in brackets."""
    for path in glob.glob(pattern):
        with contextlib.suppress(OSError):  # it has ended
            with open(path, errors="replace") as file:
                yield file.read().rpartition(")")[2].split()
