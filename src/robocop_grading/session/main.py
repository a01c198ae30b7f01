"""Runs all scenarios of one part of a submission, and writes a record file for each."""

import sys
from pathlib import Path

from ..errors import GraderLostError
from ..record import read
from .bridge_run import BridgeRun
from .job import Job, begin_to_tell, send_to_grader
from .run import Run
from .server_run import ServerRun
from .stage import Stage


def main() -> None:
    """Usage: main JOB."""
    begin_to_tell()
    try:
        job, stage = read(Job, Path(sys.argv[1])), Stage()
        run: Run = (ServerRun if job.part == "server" else BridgeRun)(job, stage)
        try:
            run.scenarios()
        finally:
            run.close()
    except GraderLostError as error:
        sys.exit(str(error))
    except OSError as error:  # a full disk, for example: nothing that a node can bring about
        send_to_grader(f"error {error}")
        sys.exit(1)


if __name__ == "__main__":
    main()
