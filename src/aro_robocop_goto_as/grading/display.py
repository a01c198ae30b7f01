"""Whether RViz could open a window here: asked before anything is built or graded."""

import os
import shutil
import subprocess
import sys
from typing import List, Optional, Sequence

from ..errors import GradingError
from .sandbox import Cage

TRIAL = 10.0  # [s, wall]
OPEN = """import ctypes, sys
x11 = ctypes.CDLL("libX11.so.6")
x11.XOpenDisplay.restype = ctypes.c_void_p
sys.exit(not x11.XOpenDisplay(None))"""


def require(around: Optional[Cage]) -> None:
    """GradingError, with what to do, unless RViz is installed and the display answers from inside the cage."""
    if shutil.which("rviz") is None:
        raise GradingError("--watch shows the run in RViz, which is not installed; ./robocop grade installs it")
    name = os.environ.get("DISPLAY", "")
    if not name:
        raise GradingError("--watch needs a display for RViz, and DISPLAY is not set; run it on a desktop, "
                           "or grade without --watch")
    plain: List[str] = [sys.executable, "-ISc", OPEN]
    if not _runs(plain):
        raise GradingError(f"--watch needs a display for RViz, and {name} (DISPLAY) does not answer; "
                           "run it on a desktop, or grade without --watch")
    if around is not None and not _runs(around.around_probe(plain)):
        raise GradingError(f"--watch needs a display of this machine: {name} (DISPLAY) is reached over the network, as "
                           "by ssh -X, and RViz runs in a network of its own; run it on a desktop, or add --unsafe")


def _runs(command: Sequence[str]) -> bool:
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=TRIAL).returncode == 0
    except subprocess.TimeoutExpired:
        return False
