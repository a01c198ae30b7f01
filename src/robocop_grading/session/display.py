"""The programs that show a watched run: RViz or the web page, and robot_state_publisher for the robot's links.

They are children of the session, as only its network has the ROS master, which the submission can't reach.
"""

import os
from pathlib import Path
from typing import List, Optional, Sequence

from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.web.access import SOCKET_VARIABLE

from ..sandbox.guard import Guard
from ..viewer import Viewer

LOG_LINES = 5
# bytes; it takes some 100 MB. Browsers must not use up the grader's limit, which ends the run.
PAGE_MEMORY = 512 * 1024**2


class Display:
    """RViz or the web page, as the viewer says."""

    def __init__(self, viewer: Viewer, share: str, log: Path) -> None:
        self.is_page = viewer.is_page
        self.name = "the web page" if self.is_page else "RViz"
        self._viewer = viewer
        self._share = share
        self._log = log
        self._processes: List[child.Child[bytes]] = []
        self._guard: Optional[Guard] = None

    def start(self) -> None:
        """Start the programs; they subscribe some time later."""
        self._start(["rosrun", "robot_state_publisher", "robot_state_publisher"], "frames")
        if self.is_page:
            arguments = [f"web_port:={self._viewer.port}", "web_frame:=odom", "view_only:=true"]
            self._start(["rosrun", "aro_robocop_goto_as", "robocop_web.py", *arguments], "page")
            self._guard = Guard(self._processes[-1].pid, memory=PAGE_MEMORY)
        else:
            restarted = ["bash", f"{self._share}/launch/restart_after_crash"]
            self._start([*restarted, "rosrun", "rviz", "rviz", "-d", f"{self._share}/rviz/grading_watch.rviz"], "rviz")

    def _start(self, command: Sequence[str], name: str) -> None:
        """Start a node in the session's process group, which the grader ends as a whole."""
        with open(self._log, "ab") as log:
            process = child.start(
                [*command, f"__name:={name}"],
                environment={**os.environ, SOCKET_VARIABLE: str(self._viewer.page_socket)},
                stdout=log,
                stderr=log,
                start_new_session=False,
                pass_fds=self._viewer.descriptors,
            )
        self._processes.append(process)

    @property
    def runs(self) -> bool:
        """Return whether RViz or the page is running; asked in every step, so it does not read the log."""
        return self._processes[-1].poll() is None

    @property
    def end(self) -> str:
        """How RViz or the page has ended, with the end of the log; empty while it runs."""
        if self.runs:
            return ""
        lines = self._log.read_text(errors="replace").splitlines()[-LOG_LINES:]
        return f"{self.name} ended (status {self._processes[-1].poll()}): {' | '.join(map(str.strip, lines))}"

    def close(self) -> None:
        """End the programs."""
        if self._guard is not None:
            self._guard.stop()
        for process in self._processes:
            child.end(process, None, grace=0.0)  # no cleanup needed
