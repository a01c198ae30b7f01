"""Operating-system processes in tests: what is still running, and a load to run beside a test."""

import contextlib
import os
import subprocess
import sys

import psutil

BUSY = "import os, sys\nwhile os.getppid() == int(sys.argv[1]): pass"  # ends with the process that started it


def processes_mentioning(folder):
    """Ids of processes with this folder's path in their environment or on their command line."""
    processes = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):  # ended meanwhile, or another user's
            if any(str(folder) in word for word in (*process.cmdline(), *process.environ().values())):
                processes.append(process.pid)
    return [pid for pid in processes if pid != os.getpid()]


@contextlib.contextmanager
def busy_processes(count=8):
    """Keep the machine busy with `count` endless loops while the block runs."""
    command = [sys.executable, "-c", BUSY, str(os.getpid())]
    running = []
    try:
        for _ in range(count):
            running.append(subprocess.Popen(command, stdin=subprocess.DEVNULL))
        yield
    finally:
        for process in running:
            process.kill()
        for process in running:
            process.wait()
