"""The programs that show a watched run: RViz or the web page, and robot_state_publisher for the robot's links.

They are children of the probe, as only the probe's network has the ROS master. What they subscribe to besides /scan and
/odom, and what they publish, is below /robocop_watch: a submission that looks up the lidar's frame in TF, which is not
there, has to fail whether or not it is watched; one that waits for a subscriber of its topics must not find the page.
"""

import os
from pathlib import Path
from typing import List, Optional, Sequence

from aro_robocop_goto_as.process import child
from aro_robocop_goto_as.web.access import SOCKET_VARIABLE

from ..handout import ACTION
from ..sandbox.guard import Guard
from ..viewer import Viewer

NAMESPACE = "/robocop_watch"
SCENE = f"{NAMESPACE}/scene"


def shown(name: str) -> str:
    """The name below NAMESPACE for /NAME; of one level, or an action's topics would look like another action server."""
    return f"{NAMESPACE}/{name[1:].replace('/', '_')}"


def is_shown(name: str) -> bool:
    """Whether a topic or a node serves only to show the run."""
    return name.startswith(f"{NAMESPACE}/")


# Topics and parameters by the name that a node uses -> by which name it finds them.
RENAMED = {
    name: shown(name)
    for name in (
        *("/tf", "/tf_static", "/rosout", "/cmd_vel"),
        *(f"{ACTION}/{name}" for name in ("goal", "status", "feedback", "result")),
        *("/robocop_sim/status", "/map", "/camera/rgb/image_raw", "/aro_robocop_goto_as_node/markers"),
        *("/robocop_rviz_goto_ac_node/status", "/robot_description"),
    )
}
RENAMED["/robocop_sim/world"] = SCENE
LOG_LINES = 5
# bytes; it takes some 100 MB. Browsers and what a submission publishes for it must not use up the grader's limit, which
# ends the run.
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
        """Start a node in the probe's session, which the grader ends as a whole."""
        renamed = [f"{old}:={new}" for old, new in RENAMED.items()]
        with open(self._log, "ab") as log:
            process = child.start(
                [*command, *renamed, f"__ns:={NAMESPACE}", f"__name:={name}"],
                environment={**os.environ, SOCKET_VARIABLE: str(self._viewer.page_socket)},
                stdout=log,
                stderr=log,
                start_new_session=False,
                pass_fds=self._viewer.descriptors,
            )
        self._processes.append(process)

    @property
    def runs(self) -> bool:
        """Whether RViz or the page is running; asked in every step, so it does not read the log."""
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
