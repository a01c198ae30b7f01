"""The commands for working on this package: tests, measurements, documentation."""

import os
import subprocess
import sys
from typing import List

from . import program
from .program import ROOT, refuse, say

LOG_LINES = 30


def test(arguments: List[str]) -> None:
    """Run the tests with pytest."""
    every = "--all" in arguments
    program.need("rviz", "hosting", "grade", "class", "web", "test", *["docs"] * every)
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


def docs(arguments: List[str]) -> None:
    """Build the documentation; a link that leads nowhere is an error."""
    if arguments not in ([], ["--serve"]):
        refuse(f"docs: expected --serve or nothing, got {' '.join(arguments)}")
    program.need("docs")
    site, log = str(program.state() / "docs"), program.state() / "log" / "docs.log"
    build = program.module(
        "mkdocs", "build", "--strict", "--config-file", f"{ROOT}/docs/site/mkdocs.yml", "--site-dir", site
    )
    if program.is_dry_run():
        program.start(*build)
    with open(log, "wb") as output:
        status = subprocess.call(build, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
    if status != 0:
        print("\n".join(log.read_text(errors="replace").splitlines()[-LOG_LINES:]), file=sys.stderr)
        refuse(f"the documentation could not be built (full log: {log})")
    say(f"the documentation is in {site}/index.html")
    if arguments:
        program.start(*program.module("http.server", "--bind", "127.0.0.1", "--directory", site, "0"))
