"""Unpacks, builds and reads a hand-in in one sandbox, and hands on what is there then, packed, to those of its nodes.

Usage: python -m robocop_grading.preparation ENVIRONMENTS <HAND_IN.tar >PREPARED.tar
The last line of its errors is the submission, or why there is none, as JSON.
"""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict, replace
from pathlib import Path
from typing import IO, Any, List, Mapping, Optional, Sequence

from robocop_hosting import child
from robocop_hosting.errors import HostingError
from robocop_hosting.workspace import Environment

from .errors import GradingError
from .files.unpacking import unpack
from .sandbox.bubblewrap import HAND_IN, OWN_ENVIRONMENT, SOURCES, Sandbox, public
from .sandbox.guard import Guard
from .sandbox.limits import MAX_PREPARATION_CPU_TIME, PREPARATION_TIMEOUT
from .submission import Script, Submission, build_environments, find, lab_folder

MAX_SHOWN = 4_000  # characters of the program's errors


def prepare(archive: Path, share: Path, state: Path, sandbox: Optional[Sandbox]) -> Submission:
    """The submission in an archive of pack(), ready to be run; it needs files beside the archive.

    GradingError says why there is none.
    """
    environments = build_environments(share, state)
    reads = [lab_folder(share, state)]
    with open(archive, "rb") as packed:
        if sandbox is None:
            return replace(read(packed, archive.with_suffix(".files"), environments), reads=reads)
        visible = {name: public(environment) for name, environment in environments.items()}
        command = [sys.executable, "-m", __name__, json.dumps(visible)]
        variables = {**public(environments[""]), "PYTHONPATH": str(SOURCES), "HOME": "/tmp", "ROS_HOME": "/tmp"}
        inside = sandbox.command_inside(command, variables, [*reads, SOURCES], Path("/tmp/home"))
        prepared = archive.with_suffix(".prepared.tar")
        answer = _answer(inside, packed, prepared)
    if "error" in answer:
        raise GradingError(answer["error"])
    for script in answer["scripts"]:
        script["path"] = Path(script["path"])
    answer.update(scripts=[Script(**it) for it in answer["scripts"]], reads=reads, archive=prepared)
    return Submission(**answer)


def _answer(command: Sequence[str], packed: "IO[bytes]", prepared: Path) -> Any:
    """What the program says; GradingError if it exceeds a limit, RuntimeError if it fails."""
    with open(prepared, "wb") as output, tempfile.TemporaryFile() as errors:
        process = child.start(command, environment=OWN_ENVIRONMENT, stdin=packed, stdout=output, stderr=errors)
        guard = Guard(process.pid, processor_time=MAX_PREPARATION_CPU_TIME)
        try:
            status = process.wait(PREPARATION_TIMEOUT)
        except subprocess.TimeoutExpired as error:
            raise GradingError(f"it was not unpacked and built within {PREPARATION_TIMEOUT:g} s") from error
        finally:
            child.end(process, None, 0.0)
            guard.stop()
        if guard.reason:
            raise GradingError(f"while it was unpacked and built: {guard.reason}")
        errors.seek(0)
        text = errors.read().decode(errors="replace")
    if status != 0:
        raise RuntimeError(f"exit status {status} {text[-MAX_SHOWN:]}")
    return json.loads(text.splitlines()[-1])


def read(packed: "IO[bytes]", folder: Path, environments: Mapping[str, Environment]) -> Submission:
    """Unpack a hand-in in `folder`, and build it on the environment of its package's name, or else of "".

    GradingError says why there is no submission.
    """
    notes: List[str] = []
    try:
        files = folder / "hand_in"
        notes += unpack(packed, files)
        entries = [*files.iterdir()]
        submission = find(entries[0] if len(entries) == 1 else files, folder / "workspace", environments)
    except (GradingError, HostingError) as error:
        text = str(error).partition(f"\nfull log: {folder}")[0]
        for place in (f"{folder}/hand_in/", f"{folder}/"):
            text = text.replace(place, "")
        raise GradingError("\n".join([text, *notes])) from error
    return replace(submission, notes=[*submission.notes, *notes])


def main() -> None:
    """Read a hand-in in the sandbox."""
    try:
        answer = asdict(read(sys.stdin.buffer, HAND_IN, json.loads(sys.argv[1])))
        subprocess.run(["bsdtar", "-c", "-f", "-", "-C", str(HAND_IN), *os.listdir(HAND_IN)], check=True)
    except GradingError as error:
        answer = {"error": str(error)}
    print(json.dumps(answer, default=str), file=sys.stderr)


if __name__ == "__main__":
    main()
