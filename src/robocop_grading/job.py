"""What the grader's process asks a session's process for."""

import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Tuple

from .plan import Plan
from .viewer import Viewer


@dataclass(frozen=True)
class Job:
    """The scenarios of one part of a hand-in that the plan's checks examine."""

    part: str
    command: Tuple[str, ...]  # of the node, in the sandbox
    environment: Mapping[str, str]
    folder: Path  # the node's
    out: Path  # for records and bags
    plan: Plan
    parameters: Mapping[str, Any]  # on the parameter server
    viewer: Optional[Viewer] = None

    def write(self) -> Path:
        """Write it to a file that only processes of the grader can write to, and return its path."""
        path = self.out / f"{self.part}.job"
        path.write_bytes(pickle.dumps(self))
        return path

    @classmethod
    def read(cls, path: str) -> "Job":
        """The job in a file that write() has made."""
        job = pickle.loads(Path(path).read_bytes())
        assert isinstance(job, cls)
        return job
