"""Counts the instructions that a simulated second takes, which other load on the machine does not change."""

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import List, Mapping, Sequence, Tuple

from . import BenchError
from .cases import Case

# Simulated seconds that are counted after the first one. A start takes 3,000 million instructions, and differs by some
# million from run to run, so cases whose second takes few instructions are counted for longer.
SECONDS, LIGHT_SECONDS = 5, 300
TIMEOUT = 3600.0  # [s, wall] of one run under valgrind, fifty times as slow as alone
COUNTED = re.compile(r"Collected : (\d+)")


def _count(case: Case, seconds: int, root: Path, checkout: Mapping[str, str]) -> int:
    python = Path(checkout["ROBOCOP_STATE"], "venv", "bin", "python")
    paths = [str(Path(__file__).parents[1]), checkout.get("PYTHONPATH", "")]
    environment = {**checkout, "PYTHONPATH": os.pathsep.join(paths), "PYTHONHASHSEED": "0"}
    program = [str(python), "-m", "bench.core", case.name, str(seconds), str(root)]
    subprocess.run(program, env=environment, capture_output=True, check=False)  # so that all modules are compiled
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=TIMEOUT, check=False)
    found = COUNTED.search(done.stderr)
    if done.returncode or not found:
        raise BenchError(f"{case.name}: {' '.join(command)} ended with status {done.returncode}: {done.stderr[-500:]}")
    return int(found[1])


def table(cases: Sequence[Case], checkouts: Mapping[str, Tuple[Path, Mapping[str, str]]]) -> str:
    """Millions of instructions for a simulated second of each case, without ROS; with two checkouts also the ratio.

    `checkouts`: the folder and the environment of each, by its name.
    """
    if shutil.which("valgrind") is None:
        raise BenchError("--instructions needs valgrind: apt install valgrind")
    lines = [["case", *checkouts, *["ratio"] * (len(checkouts) - 1)]]
    for case in cases:
        robots = len(case.namespaces)
        seconds = SECONDS if case.drive == "wheels" else max(4 * SECONDS, LIGHT_SECONDS // robots)
        counts: List[float] = []
        for root, checkout in checkouts.values():
            first, all_of_them = (_count(case, until, root, checkout) for until in (1, 1 + seconds))
            counts.append((all_of_them - first) / seconds / 1e6)
        ratios = [f"{counts[1] / counts[0]:.3f}"] if len(counts) > 1 else []
        lines.append([case.name, *(f"{count:.2f}" for count in counts), *ratios])
    return "\n".join(" | ".join(line) for line in lines)
