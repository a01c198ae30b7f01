"""robocop_web: shows the system in a browser, and sends what a visitor asks for."""

import contextlib
import io
import os
import socket
import sys
import threading
import time
from typing import Any, Callable, Dict, Optional, Sequence

import rospkg
import rospy
import yaml

from ...errors import ParameterError, RobocopError, WebError
from ...geometry import Twist2D
from ...param_loading import from_dict
from ...params import WebParams
from ...web import access
from ...web.dead_man import DeadMan
from ...web.page import Actions, Page
from ...web.replay_panel import Replay
from ...web.scene import Scene
from .. import private_api
from ..node_main import node
from .commands import Commands, Driver
from .master_watch import MasterWatch
from .player import Player
from .view import View

NAME = "robocop_web"
RATE = 12.0  # [Hz, wall] at which pages are updated; scans come at 5 or 10 Hz
IDLE_PERIOD = 1.0  # [s, wall] between two looks without a visitor
TEXTS = ("web_host", "web_frame", "web_origins", "replay")  # arguments that are not YAML
MASTER_PERIOD = 0.1  # [s, wall]


def load_params(arguments: Sequence[str]) -> WebParams:
    """Arguments NAME:=VALUE -> parameters; ParameterError for what is wrong.

    Those of ROS are left out: __name:=x, and remappings of absolute names, such as /tf:=/x/tf.
    """
    raw: Dict[str, Any] = {"web_host": access.default_host()}
    for argument in arguments:
        name, given, value = argument.partition(":=")
        if not given:
            raise ParameterError(f"arguments of {NAME}: expected NAME:=VALUE, got {argument!r}")
        if name.startswith(("_", "/")) or not value:
            continue
        try:
            raw[name] = value if name in TEXTS else yaml.safe_load(value)
        except yaml.YAMLError as error:
            raise ParameterError(f"arguments of {NAME}: {name}: {error}") from error
    return from_dict(WebParams, raw, f"arguments of {NAME}")


def start_server(p: WebParams) -> Any:
    """The page's HTTP and WebSocket server; WebError if its address can't be used."""
    try:
        import viser
    except ImportError as error:
        raise WebError(f"{error}; run ./robocop web, which installs what the page needs") from error
    listening = None
    if access.SOCKET_VARIABLE in os.environ:
        listening = socket.socket(fileno=int(os.environ[access.SOCKET_VARIABLE]))
    else:
        _require_free(p.web_host, p.web_port)
    names, origins = [socket.gethostname(), p.web_host], p.web_origins.split()

    def refusal(headers: Any) -> str:
        return access.refusal(headers.get_all("Host"), headers.get_all("Origin"), names, origins)

    answers = {
        "Content-Security-Policy": access.CONTENT_POLICY,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
    }
    with private_api.checked_requests(refusal, answers, listening):
        with contextlib.redirect_stdout(io.StringIO()):  # its table of addresses
            server = viser.ViserServer(host=p.web_host, port=p.web_port, label="robocop", verbose=False)
    if server.get_port() != p.web_port:  # viser goes on to the next port that is free
        server.stop()
        raise WebError(f"port {p.web_port} has just been taken by another program; choose another one with web_port:=N")
    return server


def _require_free(host: str, port: int) -> None:
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind(address)
    except OSError as error:
        raise WebError(
            f"can't open {host}:{port}: {error.strerror or error}; choose another address with web_host:=ADDRESS, "
            "or another port with web_port:=N"
        ) from error


class WebNode:
    """Connects the page with ROS. Visitors' requests arrive in viser's threads; everything else is done by `run`.

    With a player it shows a recording. To a recording, and if `view_only` is set, nobody can send requests.
    """

    def __init__(self, server: Any, p: WebParams, player: Optional[Player] = None) -> None:
        import viser

        self._p = p
        self._server = server
        self._player = player
        self._live = player is None and not p.view_only
        self._wake = threading.Event()
        self._wanted = ""  # the robot that was chosen last
        self._commands = Commands()
        self._driver = Driver(DeadMan(), p.web_linear_velocity, p.web_angular_velocity)
        actions = Actions(
            click=self._with_ros(self._click),
            drive=self._with_ros(self._drive),
            release=self._driver.release,
            stop=self._driver.stop,
            cancel=self._with_ros(lambda: self._commands.cancel(self._wanted)),
            pause=self._with_ros(self._commands.pause),
            step=self._with_ros(self._commands.step),
            reset=self._with_ros(self._commands.reset),
            set_factor=self._with_ros(self._commands.set_factor),
            select=self._select,
            visitors=self._wake.set,
        )
        replay = None
        if player is not None:
            replay = Replay(player.duration, p.replay_speed, player.play, player.seek, player.set_speed)
        self._page = Page(server, viser, actions, replay, self._live)
        self._view = View(self._page, Scene(server.scene), p.web_frame, rospkg.RosPack(), replay is not None)
        if player is not None:
            player.on_seek = self._view.forget
        self._master = MasterWatch(self._page.show_master_problem)

    def _with_ros(self, action: Callable[..., None]) -> Callable[..., None]:
        """The action, ignored while there is no ROS master, which the page says, and where nobody may send requests."""

        def act(*arguments: Any) -> None:
            if self._live and self._master.registered and not self._master.problem:
                action(*arguments)

        return act

    # -- requests --

    def _click(self, x: float, y: float, place: bool) -> None:
        if place:
            pose = self._view.robot_pose
            yaw = 0.0 if pose is None else pose.on_plane().yaw
            self._commands.place(self._wanted, self._p.web_frame, x, y, yaw, self._view.system.sim is not None)
        else:
            self._commands.send_goal(self._wanted, self._p.web_frame, x, y)

    def _drive(self, page: int, share: Twist2D) -> None:
        if self._driver.drive(page, self._wanted, share) and self._view.executing:
            self._commands.cancel(self._wanted)  # or the server would go on commanding the robot as well

    def _select(self, robot: str) -> None:
        self._wanted = robot
        self._wake.set()

    # -- the main thread --

    def wait_for_master(self) -> None:
        """Return when a ROS master answers; meanwhile the page says that there is none."""
        while self._master.problem:
            time.sleep(MASTER_PERIOD)

    def run(self) -> bool:
        """Serve until shutdown; True if the master has been replaced by one that does not know this node."""
        watch, view = self._master, self._view
        watch.registered = True
        rospy.on_shutdown(self._driver.end)
        if self._player is not None:
            self._player.start()
        while not rospy.is_shutdown():
            if watch.forgotten:
                self._driver.end()
                return True
            robots = watch.robots or ("",)
            if self._wanted not in robots:
                self._wanted = robots[0]
            if self._page.visited:
                if not watch.problem:  # without a master, connections that exist go on
                    view.connect(robots, self._wanted)
                with self._server.atomic():
                    view.update(robots, self._commands.answer)
                    if self._player is not None and self._page.replay_panel is not None:
                        self._page.replay_panel.show(self._player.state)
                time.sleep(1.0 / RATE)
            else:
                if not watch.problem:
                    view.close()
                    view.watch_goals(robots)
                self._wake.wait(IDLE_PERIOD)
                self._wake.clear()
        return False


def warn_of_strangers(p: WebParams) -> None:
    """A page that other machines can reach lets them drive the robot, unless it takes no requests."""
    if not access.is_loopback(p.web_host) and not p.view_only:
        rospy.logwarn(
            "the page listens on %s:%d without a password: every machine that reaches it can drive the robot",
            p.web_host,
            p.web_port,
        )


def main() -> None:
    """Serve the page until a signal; start over when the ROS master was replaced, since rospy registers only once."""
    try:
        p = load_params(sys.argv[1:])
        player = Player(p.replay, p.replay_speed) if p.replay else None
        server = start_server(p)
    except RobocopError as error:
        sys.exit(f"{NAME}: {error.code}: {error}")
    print(f"{NAME}: open {access.url(p.web_host, p.web_port)} in a browser", flush=True)
    web = WebNode(server, p, player)
    web.wait_for_master()
    replaced = False
    with node(NAME, disable_rostime=True):  # wall time: the page stays alive while simulated time is paused
        warn_of_strangers(p)
        replaced = web.run()
    if replaced:  # this closes the port, and browsers connect again by themselves
        os.execv(sys.executable, [sys.executable, *sys.argv])
    server.stop()
