"""The page's panel: texts, buttons, plots. Built once and shared by all browsers, so all show the same."""

import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ..geometry import Pose3D, Twist2D, Vector3
from . import text
from .pick import floor_point
from .series import Series
from .state import Ended, ReplayState, SimState

SEND_GOAL, PLACE_ROBOT = "sends a goal", "places the robot"
HOLD_RATE = 10.0  # [Hz] at which a page renews the request of a button that is held
CAMERA, LOOK_AT, FIELD = (0.5, -6.6, 6.8), (0.5, -0.2, 0.0), 0.75  # [m] in the fixed frame, [rad]; a room of 5 x 5 m
PAUSE, RUN, STEP, RESET, PLAY = "Pause", "Run", "Step", "Reset", "Play"
SETTLED = 2.0  # [s, wall] after a visitor has moved a slider: until then what is reported may be older than that
SLIDER_STEP = 0.1  # [s, recorded] of a recording's slider
PAD = (
    # label, hot key, icon, forward, counter-clockwise
    ("Forward (I)", "I", "ARROW_UP", 1.0, 0.0),
    ("Turn left (J)", "J", "ARROW_BACK_UP", 0.0, 1.0),
    ("Turn right (L)", "L", "ARROW_FORWARD_UP", 0.0, -1.0),
    ("Backward (K)", "K", "ARROW_DOWN", -1.0, 0.0),
)
PLOT_HEIGHT = 130  # [pixel]


@dataclass(frozen=True)
class Actions:
    """What the page asks for; called from viser's threads, and none may block."""

    click: Callable[[float, float, bool], None]  # x, y [m] in the fixed frame; whether to place the robot there
    drive: Callable[[int, Twist2D], None]  # page, velocity as a share of the full speed, -1 to 1
    release: Callable[[int], None]  # page
    stop: Callable[[], None]
    cancel: Callable[[], None]
    pause: Callable[[bool], None]  # or run
    step: Callable[[], None]
    reset: Callable[[], None]
    set_factor: Callable[[float], None]
    select: Callable[[str], None]  # robot
    visitors: Callable[[], None]  # a browser has come or gone


@dataclass(frozen=True)
class Replay:
    """A recording that is shown instead of a running system, and what the page asks for; none may block."""

    duration: float  # [s, recorded]
    speed: float  # at the beginning
    play: Callable[[bool], None]  # or pause
    seek: Callable[[float], None]  # to a moment [s, recorded]
    set_speed: Callable[[float], None]


class _Html:
    """An HTML element of the panel, sent when it changes."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._content = ""

    def show(self, content: str) -> None:
        if content != self._content:
            self._handle.content = self._content = content
            self._handle.visible = bool(content)


class Page:
    """The panel of a viser server. The show_ and set_ methods are called from one thread."""

    def __init__(self, server: Any, viser: Any, actions: Actions, replay: Optional[Replay] = None) -> None:
        self._server = server
        self._actions = actions
        self._pages: Dict[int, Any] = {}
        self._followed: Optional[Vector3] = None
        self._factor_set = self._moment_set = 0.0  # [s, wall] when a visitor moved the slider
        self._replay = replay
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
        self._master_alert = _Html(gui.add_html("", visible=False))
        self._alert = _Html(gui.add_html("", visible=False))
        self._overview = _Html(gui.add_html(""))
        self._answer = _Html(gui.add_html("", visible=False))
        self._robot = gui.add_dropdown("Robot", ("",), visible=False, hint="shown in detail and driven")
        self._robot.on_update(self._on_select)
        live = self._replay is None
        if self._replay is not None:
            self._build_replay(gui, self._replay)
        self._mode = gui.add_dropdown("A click", (SEND_GOAL, PLACE_ROBOT), visible=live, hint="on the floor")
        self._button("Cancel goal", "X", lambda: self._actions.cancel(), live)
        with gui.add_folder("Goal"):
            self._feedback = _Html(gui.add_html("", visible=False))
            self._history = _Html(gui.add_html(""))
        self._time = gui.add_folder("Time", visible=False)
        with self._time:
            gui.add_button_group("Simulation", (PAUSE, RUN, STEP, RESET)).on_click(self._on_time)
            self._factor = gui.add_slider("Factor", 0.1, 10.0, 0.1, 1.0, hint="simulated seconds per second")
            self._factor.on_update(self._on_factor)
        self._build_pad(gui, live)
        with gui.add_folder("Plots"):
            self._errors = self._plot(gui, "errors", ("position [m]", "angle [rad]"))
            self._commands = self._plot(gui, "cmd_vel", ("v [m/s]", "w [rad/s]"))
        with gui.add_folder("View"):
            self._follow = gui.add_checkbox("Follow the robot", False)
            self._frames = gui.add_checkbox("Frames", False)
            self._trail = gui.add_checkbox("Trail", True)
            self._image = gui.add_image(np.zeros((3, 4, 3), np.uint8), label="camera", visible=False)

    def _build_replay(self, gui: Any, replay: Replay) -> None:
        self._progress = _Html(gui.add_html(""))
        buttons = gui.add_button_group("Recording", (PLAY, PAUSE))
        buttons.on_click(lambda event: replay.play(event.target.value == PLAY))
        longest = max(round(replay.duration, 1), SLIDER_STEP)
        self._moment = gui.add_slider("Time", 0.0, longest, SLIDER_STEP, 0.0, hint="seconds since the beginning")
        self._moment.on_update(self._on_moment)
        self._speed = gui.add_slider("Speed", 0.1, 10.0, 0.1, replay.speed, hint="recorded seconds per second")
        self._speed.on_update(lambda event: replay.set_speed(event.target.value))

    def _build_pad(self, gui: Any, live: bool) -> None:
        with gui.add_folder("Drive", visible=live):
            for label, key, icon, forward, turn in PAD:
                share = Twist2D(forward, turn)
                button = gui.add_button(label, icon=getattr(self._icons, icon), hint="drives while it is held")
                button.on_hold(self._holder(share), callback_hz=HOLD_RATE)
                button.on_click(self._on_release)
                command = gui.add_command(label, hotkey=key, description="drives while the key is held")
                command.on_trigger(self._holder(share))
            self._button("Stop", "HAND_STOP", lambda: self._actions.stop())

    def _button(self, label: str, icon: str, action: Callable[[], None], visible: bool = True) -> Any:
        button = self._server.gui.add_button(label, icon=getattr(self._icons, icon), visible=visible)
        button.on_click(lambda _event: action())
        return button

    def _holder(self, share: Twist2D) -> Callable[[Any], Any]:
        # Coroutines run one after the other in viser's event loop; functions would run in its thread pool, where a late
        # request could overtake the release.
        async def hold(event: Any) -> None:
            self._actions.drive(event.client_id, share)

        return hold

    async def _on_release(self, event: Any) -> None:
        """The pointer was released over its button of the pad; if released elsewhere, the requests just stop."""
        self._actions.release(event.client_id)

    def _on_time(self, event: Any) -> None:
        wanted = event.target.value
        if wanted in (PAUSE, RUN):
            self._actions.pause(wanted == PAUSE)
        elif wanted == STEP:
            self._actions.step()
        elif wanted == RESET:
            self._actions.reset()

    def _on_select(self, event: Any) -> None:
        if event.client is not None:
            self._actions.select(event.target.value)

    def _on_factor(self, event: Any) -> None:
        if event.client is not None:
            self._factor_set = time.monotonic()
            self._actions.set_factor(event.target.value)

    def _on_moment(self, event: Any) -> None:
        if event.client is not None and self._replay is not None:
            self._moment_set = time.monotonic()
            self._replay.seek(event.target.value)

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
        self._overview.show(text.overview(sim, robots, bridge))
        controllable = sim is not None and self._replay is None
        if self._time.visible != controllable:
            self._time.visible = controllable
        if sim is None:
            return
        settled = time.monotonic() - self._factor_set > SETTLED
        asked = min(max(sim.factor_asked, 0.1), 10.0)
        if settled and sim.factor_asked > 0.0 and abs(self._factor.value - asked) > 1e-6:
            self._factor.value = asked

    def show_replay(self, state: ReplayState) -> None:
        """How far the recording has been played."""
        self._progress.show(text.progress(state))
        moment = min(round(state.position, 1), self._moment.max)
        if time.monotonic() - self._moment_set > SETTLED and abs(self._moment.value - moment) > SLIDER_STEP / 2.0:
            self._moment.value = moment

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
