"""What shows a watched run: RViz if it can open a window here, otherwise the web page.

Both run in the session's network, which has the ROS master and which nothing else can reach. RViz gets to its display
through a Unix socket; the page is handed a listening socket that was opened here, in the machine's own network.
"""

import os
import shutil
import socket
import subprocess
import sys
from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.probes import x_display
from aro_robocop_goto_as.web import access
from aro_robocop_goto_as.web_params import WebParams

from .sandbox.bubblewrap import Sandbox

BACKLOG = 100  # browsers' connections that wait while the page's node starts


@dataclass(frozen=True)
class Viewer:
    """RViz, or the web page if there is a socket for it."""

    page_socket: int = -1  # file descriptor of a listening socket
    port: int = 0
    url: str = ""

    @property
    def is_page(self) -> bool:
        """Return whether the run is shown by the web page."""
        return self.page_socket >= 0

    @property
    def descriptors(self) -> Tuple[int, ...]:
        """Files that the session inherits."""
        return (self.page_socket,) if self.is_page else ()


def choose_viewer(sandbox: Optional[Sandbox]) -> Viewer:
    """RViz where it is installed and the display answers from inside the sandbox, otherwise the web page.

    GradingError if no port can be opened for the page.
    """
    command = [sys.executable, "-IS", x_display.__file__]
    if sandbox is not None:
        command = sandbox.session_command(command)  # without a network: the display of ssh -X does not answer
    if os.environ.get("DISPLAY") and shutil.which("rviz") is not None:
        if subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True).returncode == 0:
            return Viewer()
    host = access.default_host()
    # From elsewhere, as from outside a container, only the usual port may be reachable.
    ports = (WebParams.web_port, 0) if access.is_loopback(host) else (WebParams.web_port,)
    listening = _listen(host, ports)
    port = listening.getsockname()[1]
    return Viewer(listening.detach(), port, access.url(host, port))


def _listen(host: str, ports: Sequence[int]) -> socket.socket:
    """A socket on the first of these ports that is free; 0 means any port."""
    problem = ""
    for port in ports:
        try:
            family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
            return socket.create_server((host, port), family=family, backlog=BACKLOG)
        except OSError as error:
            problem = f"{host}:{port}: {(error.strerror or str(error)).partition(' (while attempting')[0]}"
    raise GradingError(f"--watch can't open a port for its web page, end what uses it: {problem}")
