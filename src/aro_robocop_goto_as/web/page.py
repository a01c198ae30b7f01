"""The page's panel: texts, buttons, plots. Built once and shared by all browsers, so all show the same."""

import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ..geometry import Pose3D, Vector3
from . import text
from .drive_pad import Drive, Release, add_drive_pad
from .panel_html import Html
from .pick import floor_point
from .replay_panel import SETTLED, Replay, ReplayPanel
from .series import Series
from .state import Ended, SimState

SEND_GOAL, PLACE_ROBOT = "sends a goal", "places the robot"
CAMERA, LOOK_AT, FIELD = (0.5, -6.6, 6.8), (0.5, -0.2, 0.0), 0.75  # [m] in the fixed frame, [rad]; a room of 5 x 5 m
PAUSE, RUN, STEP, RESET = "Pause", "Run", "Step", "Reset"
PLOT_HEIGHT = 130  # [pixel]


@dataclass(frozen=True)
class Actions:
    """What the page asks for; called from viser's threads, and none may block."""

    click: Callable[[float, float, bool], None]  # x, y [m] in the fixed frame; whether to place the robot there
    drive: Drive
    release: Release
    stop: Callable[[], None]
    cancel: Callable[[], None]
    pause: Callable[[bool], None]  # or run
    step: Callable[[], None]
    reset: Callable[[], None]
    set_factor: Callable[[float], None]
    select: Callable[[str], None]  # robot
    visitors: Callable[[], None]  # a browser has come or gone


class Page:
    """The panel of a viser server. The show_ and set_ methods are called from one thread."""

    def __init__(
        self, server: Any, viser: Any, actions: Actions, replay: Optional[Replay] = None, live: bool = True
    ) -> None:
        """`live`: visitors can send requests to the system; otherwise they only watch it, or a recording."""
        self._server = server
        self._actions = actions
        self._pages: Dict[int, Any] = {}
        self._followed: Optional[Vector3] = None
        self._factor_set = 0.0  # [s, wall] when a visitor moved the slider
        self._factor_agreed = 0.0  # [s, wall] when it was last found to show the simulator's factor
        self._replay = replay
        self._live = live
        self._icons = viser.Icon
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, control_width="medium")
        camera = server.initial_camera
        camera.position, camera.look_at, camera.fov = CAMERA, LOOK_AT, FIELD
        self._build(server.gui)
        server.scene.on_click()(self._on_click)
        server.on_client_connect(self._on_connect)
        server.on_client_disconnect(self._on_disconnect)

    # -- the panel --

    def _build(self, gui: Any) -> None:
        self._master_alert = Html(gui.add_html("", visible=False))
        self._alert = Html(gui.add_html("", visible=False))
        self._overview = Html(gui.add_html(""))
        self._answer = Html(gui.add_html("", visible=False))
        self._robot = gui.add_dropdown("Robot", ("",), visible=False, hint="shown in detail and driven")
        self._robot.on_update(self._on_select)
        self.replay_panel = None if self._replay is None else ReplayPanel(gui, self._replay)
        self._mode = gui.add_dropdown("A click", (SEND_GOAL, PLACE_ROBOT), visible=self._live, hint="on the floor")
        self._button("Cancel goal", "X", self._actions.cancel, self._live)
        with gui.add_folder("Goal"):
            self._feedback = Html(gui.add_html("", visible=False))
            self._history = Html(gui.add_html(""))
        self._time = gui.add_folder("Time", visible=False)
        with self._time:
            gui.add_button_group("Simulation", (PAUSE, RUN, STEP, RESET)).on_click(self._on_time)
            self._factor = gui.add_slider("Factor", 0.1, 10.0, 0.1, 1.0, hint="simulated seconds per second")
            self._factor.on_update(self._on_factor)
        with gui.add_folder("Drive", visible=self._live):
            add_drive_pad(gui, self._icons, self._actions.drive, self._actions.release)
            self._button("Stop", "HAND_STOP", self._actions.stop)
        with gui.add_folder("Plots"):
            self._errors = self._plot(gui, "errors", ("position [m]", "angle [rad]"))
            self._commands = self._plot(gui, "cmd_vel", ("v [m/s]", "w [rad/s]"))
        with gui.add_folder("View"):
            self._follow = gui.add_checkbox("Follow the robot", False)
            self._frames = gui.add_checkbox("Frames", False)
            self._trail = gui.add_checkbox("Trail", self._live or self._replay is not None)
            self._image = gui.add_image(np.zeros((3, 4, 3), np.uint8), label="camera", visible=False)

    def _button(self, label: str, icon: str, action: Callable[[], None], visible: bool = True) -> Any:
        button = self._server.gui.add_button(label, icon=getattr(self._icons, icon), visible=visible)
        button.on_click(lambda _event: action())
        return button

    def _on_time(self, event: Any) -> None:
        wanted = event.target.value
        if wanted in (PAUSE, RUN):
            self._actions.pause(wanted == PAUSE)
        elif wanted == STEP:
            self._actions.step()
        elif wanted == RESET:
            self._actions.reset()

    async def _on_select(self, event: Any) -> None:  # a coroutine, as _on_factor
        if event.client is not None:
            self._actions.select(event.target.value)

    async def _on_factor(self, event: Any) -> None:  # a coroutine: in viser's thread pool it could come late
        if event.client is not None:
            self._factor_set = time.monotonic()
            self._actions.set_factor(event.target.value)

    @staticmethod
    def _plot(gui: Any, title: str, names: Tuple[str, str]) -> Any:
        series = ({"label": "t [s]"},) + tuple(
            {"label": name, "stroke": color, "width": 1.5} for name, color in zip(names, ("#4dabf7", "#ffa94d"))
        )
        axes = ({"stroke": "#adb5bd", "grid": {"show": False}}, {"stroke": "#adb5bd", "grid": {"show": False}})
        return gui.add_uplot(
            Series(2).columns(0.0),
            series,
            title=title,
            scales={"x": {"time": False}},
            axes=axes,
            height=PLOT_HEIGHT,
            padding=(4, 8, 0, 0),
        )

    # -- visitors --

    def _on_click(self, event: Any) -> None:
        point = floor_point(event.ray_origin, event.ray_direction)
        if point is not None:
            self._actions.click(*point, self._mode.value == PLACE_ROBOT)

    def _on_connect(self, client: Any) -> None:
        self._pages[client.client_id] = client
        self._actions.visitors()

    async def _on_disconnect(self, client: Any) -> None:
        self._pages.pop(client.client_id, None)
        self._actions.release(client.client_id)
        self._actions.visitors()

    @property
    def visited(self) -> bool:
        """Whether a browser shows the page."""
        return bool(self._pages)

    # -- what it shows --

    @property
    def shows_frames(self) -> bool:
        """Whether the coordinate frames are to be shown."""
        return bool(self._frames.value)

    @property
    def shows_trail(self) -> bool:
        """Whether the trail is to be shown."""
        return bool(self._trail.value)

    def show_master_problem(self, problem: str) -> None:
        """Why the ROS master does not answer, at the top; nothing if it does. May be called from any one thread."""
        self._master_alert.show(text.alert(f"ROS does not answer: {problem}." if problem else ""))

    def show_alert(self, message: str) -> None:
        """A problem of the whole system, at the top; none if empty."""
        self._alert.show(text.alert(message))

    def show_answer(self, message: str) -> None:
        """What became of the last request."""
        self._answer.show(f'<div style="{text.STYLE}" role="status">{text.plain(message)}</div>' if message else "")

    def show_robots(self, names: Sequence[str], selected: str) -> None:
        """The robots to choose from; a single one needs no choice."""
        options = tuple(names) or ("",)
        if self._robot.options != options:
            self._robot.options = options
        if selected in options and self._robot.value != selected:
            self._robot.value = selected
        if self._robot.visible != (len(options) > 1):
            self._robot.visible = len(options) > 1

    def show_sim(self, sim: Optional[SimState], robots: int, bridge: str) -> None:
        """The simulator's report, None for a robot without one, and the bridge's."""
        known = self._live or sim is not None or bridge  # a grader's run, or its recording, has neither
        self._overview.show(text.overview(sim, robots, bridge) if known else "")
        controllable = sim is not None and self._live
        if self._time.visible != controllable:
            self._time.visible = controllable
        if sim is None:
            return
        now, asked = time.monotonic(), min(max(sim.factor_asked, 0.1), 10.0)
        if sim.factor_asked <= 0.0 or abs(self._factor.value - asked) < 1e-6:
            self._factor_agreed = now
        elif now - max(self._factor_agreed, self._factor_set) > SETTLED:
            self._factor.value = asked  # not at once: a visitor's value may be on its way, and would be overwritten

    def show_feedback(self, content: Optional[Tuple[float, float, str]]) -> None:
        """The newest feedback, None while no goal is executed."""
        self._feedback.show("" if content is None else text.feedback(*content))

    def show_history(self, ended: List[Ended], several: bool) -> None:
        """The last goals, with the robots' names if there are several."""
        self._history.show(text.history(ended, several))

    def show_plots(self, errors: Series, commands: Series, now: float) -> None:
        """What has changed in the two plots."""
        for plot, series in ((self._errors, errors), (self._commands, commands)):
            if series.changed:
                plot.data = series.columns(now)

    def show_image(self, image: Optional[np.ndarray]) -> None:
        """A camera's image (rows, columns, 3), or none."""
        if image is not None:
            self._image.image = image
        if self._image.visible != (image is not None):
            self._image.visible = image is not None

    def follow(self, robot: Optional[Pose3D]) -> None:
        """Move the cameras along with the robot's pose in the fixed frame, if that is wanted."""
        if robot is None or not self._follow.value:
            self._followed = None
            return
        if self._followed is None:
            self._followed = robot.position
        moved = np.subtract(robot.position, self._followed)
        if float(np.abs(moved).max()) < 0.005:
            return
        self._followed = robot.position
        for client in list(self._pages.values()):
            if client.camera.update_timestamp:
                client.camera.position = client.camera.position + moved
