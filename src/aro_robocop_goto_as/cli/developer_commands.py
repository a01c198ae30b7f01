"""The commands for working on this package: tests, measurements."""

import os
from typing import List

from . import program
from .program import ROOT


def test(arguments: List[str]) -> None:
    """Run the tests with pytest."""
    every = "--all" in arguments
    program.need("rviz", "hosting", "grade", "class", "web", "test")
    os.chdir(ROOT)
    for tool in ("HYPOTHESIS_STORAGE_DIRECTORY", "MYPY_CACHE_DIR", "RUFF_CACHE_DIR"):
        os.environ[tool] = str(program.state() / tool.partition("_")[0].lower())
    # Run one test more at a time than there are processors, as tests often wait. With --all, pyproject.toml sets two,
    # because its attacks and load tests are designed for one test beside them.
    workers = [] if every else ["-n", str(len(os.sched_getaffinity(0)) + 1)]
    program.start(*program.module("pytest", "-o", f"cache_dir={program.state()}/pytest", *workers, *arguments))


def bench(arguments: List[str]) -> None:
    """Measure the simulator."""
    program.need()
    python, *_ = program.module("")
    program.start(python, str(ROOT / "test" / "robocop_bench.py"), *arguments)
