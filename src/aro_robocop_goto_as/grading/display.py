"""Whether RViz can open a window here, checked before anything is built or graded."""

import os
import shutil
import subprocess
import sys
from typing import Optional, Sequence

from ..errors import GradingError
from ..process import x_display
from .sandbox import Sandbox

ADVICE = "run it on a desktop, or grade without --watch"


def require_rviz(sandbox: Optional[Sandbox]) -> None:
    """GradingError, with advice, unless RViz is installed and the display answers from inside the sandbox."""
    if shutil.which("rviz") is None:
        raise GradingError("--watch shows the run in RViz, which is not installed; ./robocop grade installs it")
    name = os.environ.get("DISPLAY", "")
    if not name:
        raise GradingError(f"--watch needs a display for RViz, and DISPLAY is not set; {ADVICE}")
    command = [sys.executable, "-IS", x_display.__file__]
    if not _succeeds(command):
        raise GradingError(f"--watch needs a display for RViz, and {name} (DISPLAY) does not answer; {ADVICE}")
    if sandbox is not None and not _succeeds(sandbox.probe_command(command)):
        raise GradingError(
            f"--watch needs a display of this machine: {name} (DISPLAY) is reached over the network, as "
            "by ssh -X, and RViz runs in a network of its own; run it on a desktop, or add --unsafe"
        )


def _succeeds(command: Sequence[str]) -> bool:
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True).returncode == 0
