"""Building a wheel from the source release of a PyPI package, for a Python that PyPI has none for.

As a program: build_wheel PYTHON REQUIREMENT FOLDER, with pip's output on standard output; exit status 0 if FOLDER now
has a wheel of REQUIREMENT (NAME==VERSION) for PYTHON.
"""

import contextlib
import fcntl
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Dict, Iterator, List

CORE_MINUTES = 11.0  # pybullet 3.2.7 on Debian 13: 5.5 minutes on two cores
PROGRESS_PERIOD = 30.0  # [s, wall]
# GCC 14 treats as an error what pybullet's C code does with NumPy's pointers.
CFLAGS = "-Wno-incompatible-pointer-types"


def _say(text: str) -> None:
    print(f"robocop: {text}", file=sys.stderr, flush=True)


def duration(seconds: float) -> str:
    """For a person: 40 s, 2 min 05 s."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the folder's lock."""
    with open(folder / ".lock", "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            _say("waiting for another checkout, which is building a wheel")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _has_wheel(pip: List[str], requirement: str, folder: Path, scratch: str) -> bool:
    command = [*pip, "download", "--no-index", "--no-deps", "--only-binary", ":all:", "--find-links", str(folder)]
    return subprocess.call([*command, "--dest", scratch, requirement], stderr=subprocess.STDOUT) == 0


def _run_with_progress(command: List[str], environment: Dict[str, str], what: str) -> int:
    start = time.monotonic()
    with subprocess.Popen(command, env=environment, stderr=subprocess.STDOUT) as process:
        while True:
            try:
                return process.wait(PROGRESS_PERIOD)
            except subprocess.TimeoutExpired:
                _say(f"building {what}: {duration(time.monotonic() - start)}")


def build(python: str, requirement: str, folder: Path) -> bool:
    """Build the wheel with all that `python` can import, and move it to `folder` when it is complete.

    No isolated build environment: in pip's own, pybullet finds no NumPy and is built without its support. No pip cache:
    it may hold such a wheel. The scratch folder is on the disk of `folder`, because /tmp may be a small one in memory.
    """
    name = requirement.partition("=")[0]
    pip = [python, "-m", "pip", "--no-cache-dir", "--disable-pip-version-check"]
    folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder), tempfile.TemporaryDirectory(prefix=".build-", dir=folder) as scratch:
        if _has_wheel(pip, requirement, folder, scratch):
            return True
        cores = len(os.sched_getaffinity(0))
        minutes = max(2, math.ceil(CORE_MINUTES / cores))
        _say(f"building {requirement} on {cores} cores; this takes about {minutes} minutes, once for all checkouts")
        environment = {**os.environ, "TMPDIR": scratch, "CFLAGS": f"{os.environ.get('CFLAGS', '')} {CFLAGS}".strip()}
        wheels = Path(scratch, "wheels")
        command = [*pip, "wheel", "--no-deps", "--no-build-isolation", "--no-binary", name, "--retries", "2"]
        status = _run_with_progress([*command, "--wheel-dir", str(wheels), requirement], environment, requirement)
        if status == 0:
            for wheel in wheels.glob("*.whl"):
                wheel.replace(folder / wheel.name)
                _say(f"the wheel is kept as {folder / wheel.name}")
        return status == 0


def main() -> None:
    """Build; exit status 130 if interrupted."""
    python, requirement, folder = sys.argv[1:]
    try:
        sys.exit(0 if build(python, requirement, Path(folder)) else 1)
    except OSError as error:  # the folder is not writable, the disk is full
        sys.exit(str(error))
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
