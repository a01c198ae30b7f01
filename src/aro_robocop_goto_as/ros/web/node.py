"""robocop_web: shows the system in a browser, and sends what a visitor asks for."""

import sys
import threading
import time
from typing import Any, List, Optional, Sequence

import rosgraph
import rospy

from ...errors import ParameterError, RobocopError
from ...names import WEB
from ...param_loading import from_texts
from ...web import access, text
from ...web.page import BrowserCameras, set_up
from ...web.params import WebParams
from ...web.scene import PageScene, color_of
from ...web.state import PageState, SharedState
from .. import markers
from ..node_main import answer_help, end_with_master, node
from .frames import Frames
from .goals import GoalsPart
from .part import Context, Inbox, Part
from .plots import plots
from .replay import ReplayPart
from .requests import Requests
from .robots import RobotsPart
from .scenery import SceneryPart
from .server import LAB, start_server
from .status import StatusPart
from .teleop import TeleopPart
from .time_controls import TimePart
from .view import ViewPart

RATE = 12.0  # [Hz, wall] at which pages are updated; scans come at 5 or 10 Hz
IDLE_PERIOD = 1.0  # [s, wall] between two checks without a visitor
SECTOR = {"free": markers.FREE, "near": markers.NEAR, "too near": markers.BLOCKED, "no scan": markers.UNKNOWN}
ASK_PERIOD = 1.0  # [s, wall] between two requests of the parts to the ROS master


def load_params(arguments: Sequence[str]) -> WebParams:
    """Arguments NAME:=VALUE -> parameters; ParameterError for what is wrong.

    Arguments for ROS are left out: __name:=x, and remappings of absolute names, such as /tf:=/x/tf.
    """
    for argument in arguments:
        if ":=" not in argument:
            raise ParameterError(f"arguments of {WEB}: expected NAME:=VALUE, got {argument!r}")
    given = {"web_host": access.default_host()}
    mappings = rosgraph.names.load_mappings(arguments)
    given.update((name, text) for name, text in mappings.items() if text and name[0] not in "_/")
    return from_texts(WebParams, given, f"arguments of {WEB}")


def add_parts(context: Context, p: WebParams) -> List[Part]:
    """Add what the panel shows below the status: goals, tabs, the buttons that drive."""
    can_send = context.state.now.can_send
    parts: List[Part] = [ReplayPart(context, p.replay_waits)] if p.replay else []
    parts.append(GoalsPart(context))
    tabs = context.server.gui.add_tab_group()
    with tabs.add_tab("Control" if can_send else "View"):
        parts += [TimePart(context), ViewPart(context)]
        sector = {words: color_of((c.r, c.g, c.b, c.a))[0] for words, c in SECTOR.items()}
        context.server.gui.add_html(text.legend("sector ahead", sector))
        if can_send and LAB.is_file():
            context.server.gui.add_html(text.link("/lab.md", "The lab, step by step"))
    with tabs.add_tab("Plots"):
        parts += plots(context)
    parts.append(TeleopPart(context, p.web_linear_velocity, p.web_angular_velocity))
    return parts


class WebNode:
    """Updates all parts of the page. Visitors' requests arrive in viser's threads; `run` does everything else.

    To a recording, and if `view_only` is set, nobody can send requests.
    """

    def __init__(self, server: Any, p: WebParams) -> None:
        self._server = server
        self._state = SharedState(PageState(can_send=not p.replay and not p.view_only, recorded=bool(p.replay)))
        scene, requests = PageScene(server.scene), Requests(self._state)
        context = Context(server, scene, self._state, requests, Frames(), p.web_frame)
        set_up(server)
        cameras = BrowserCameras(server)
        self._parts = [RobotsPart(context), StatusPart(context), *add_parts(context, p), SceneryPart(context, cameras)]
        self._system, self._detail = Inbox(), Inbox()  # topics of the system and of the selected robot
        self._robot: Optional[str] = None  # the robot with subscribed topics; None while there is no visitor
        self._asked = 0.0  # [s, wall] when the parts asked the master last
        self._visitors = threading.Event()  # a browser has come or gone
        server.on_client_connect(lambda _: self._visitors.set())
        server.on_client_disconnect(lambda _: self._visitors.set())

    def run(self) -> None:
        """Serve until shutdown."""
        while not rospy.is_shutdown():
            visited = bool(self._server.get_clients())
            self._connect(visited)
            self._system.deliver()
            self._detail.deliver()
            if visited:
                with self._server.atomic():
                    for part in self._parts:
                        part.show(self._state.now)
                time.sleep(1.0 / RATE)
            else:
                self._visitors.wait(IDLE_PERIOD)
                self._visitors.clear()

    def _connect(self, visited: bool) -> None:
        """Subscribe to the shown topics, if anybody looks. Only this needs the ROS master, and may wait for it."""
        state = self._state.now
        wanted = state.selected if visited else None
        if wanted is None:
            self._system.close()
        elif self._robot is None:
            for part in self._parts:
                part.subscribe(self._system)
        if wanted != self._robot:
            self._robot = wanted
            self._detail.close()
            for part in self._parts if wanted is not None else ():
                part.subscribe_to_robot(self._detail, state.selected)
        if time.monotonic() - self._asked >= ASK_PERIOD:
            self._asked = time.monotonic()
            for part in self._parts:
                part.ask_master(self._state.now)


def consequence(arguments: Sequence[str]) -> str:
    """What follows where the page can't start, as the end of a sentence; of the launch files only a replay needs it."""
    given = rosgraph.names.load_mappings(arguments)
    return "; everything else runs on, without the page" if "__log" in given and "replay" not in given else ""


def main() -> None:
    """Serve the page until a signal, or the end of the ROS master."""
    answer_help("The web page that shows the running system in a browser.", "[web_port:=N] [web_host:=ADDRESS]")
    try:
        p = load_params(sys.argv[1:])
        server = start_server(p)
    except RobocopError as error:
        sys.exit(f"{WEB}: {error.code}: {error}{consequence(sys.argv)}")
    with node(WEB, disable_rostime=True):  # wall time: the page stays alive while simulated time is paused
        end_with_master()
        print(f"{WEB}: open {access.url(p.web_host, p.web_port)} in a browser", flush=True)
        if not access.is_loopback(p.web_host) and not p.view_only:
            warning = "the page listens on %s:%d without a password: every machine that reaches it can drive the robot"
            rospy.logwarn(warning, p.web_host, p.web_port)
        WebNode(server, p).run()
    server.stop()
