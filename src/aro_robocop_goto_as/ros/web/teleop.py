"""The buttons and keys that drive a robot while they are held."""

import contextlib
import threading
import time
from typing import Any, Callable, Dict

import rospy
from geometry_msgs.msg import Twist

from ...geometry import Twist2D
from ...names import absolute
from ...web.dead_man import RATE, DeadMan
from .. import convert
from ..waiting import wait_until
from .goals import cancel
from .part import Context, Part

END_TIMEOUT = 0.5  # [s, wall]
PERIOD = 0.1  # [s, wall]
IDLE_TIMEOUT = 3.0  # [s, wall] without driving until cmd_vel is given up
PAD = (  # in the order of the grid's cells
    # label, hot key, share of the full speed
    ("Stop", None, None),
    ("Forward", "I", Twist2D(1.0, 0.0)),
    ("Left", "J", Twist2D(0.0, 1.0)),
    ("Back", "K", Twist2D(-1.0, 0.0)),
    ("Right", "L", Twist2D(0.0, -1.0)),
)
# The panel has no rows of buttons: this style arranges the buttons of its folder as the arrow keys of a keyboard. The
# folder stays at the lower edge of a panel that is scrolled, where a thumb reaches it. 44 px is the smallest control
# for a finger by the W3C (WCAG 2.5.5) and by Apple. Hot keys are shown only where there is a mouse.
# On a phone held upright the open folder would cover the tabs, so it is folded once; this style is loaded more often.
STYLE = """<style class="pad" onload="window.padIsPlaced ??= (matchMedia('(max-width: 36em)').matches &&
  [...document.querySelectorAll('div')].find(e => e.firstChild?.nodeValue === 'Drive')?.click(), true)">
div:has(> div > .pad) {
  display: grid; grid-template-columns: repeat(3, 1fr); padding: 0.6em 0.3em 0;
  & > div { margin-inline: 0.2em !important; button { padding-inline: 0; touch-action: none; } }
  & > :nth-child(1) { display: none; }
  & > :nth-child(4) { grid-column: 1; }
}
div:has(> div > div > div > div > .pad) {
  position: sticky; bottom: 0; z-index: 5; background: var(--mantine-color-body);
}
div[style*="overflow: hidden; min-height"]:has(.pad) { overflow: clip !important; } /* or nothing in it can be sticky */
@media (pointer: coarse) { .mantine-Button-root { min-height: 44px; } }
@media (max-height: 30em) { /* a phone that is turned */
  div:has(> div > .pad) { grid-template-columns: repeat(5, 1fr); & > :nth-child(4) { grid-column: auto; } }
}
@media (pointer: fine) { KEYS }
</style>"""
KEYS = "".join(
    f'div:has(> div > .pad) > :nth-child({2 + number}) .mantine-Button-label::after {{ content: "\\a0({key})"; }}'
    for number, (_, key, _) in enumerate(PAD)
    if key
)


class TeleopPart(Part):
    """Publishes cmd_vel while somebody drives, from a thread of its own, so that nothing else can delay a stop.

    Otherwise there is no publisher: a simulator in lockstep treats every publisher of cmd_vel as a controller.
    """

    def __init__(self, context: Context, linear: float, angular: float) -> None:
        """Full speed: linear [m/s], angular [rad/s]."""
        super().__init__(context)
        self._dead_man = DeadMan()
        self._wake = threading.Condition()
        gui = context.server.gui
        with gui.add_folder("Drive", visible=context.state.now.can_send):
            gui.add_html(STYLE.replace("KEYS", KEYS))
            for label, key, share in PAD:
                if share is None:
                    gui.add_button(label, icon="hand-stop").on_click(lambda _: self.stop())
                    continue
                hold = self._holder(Twist2D(share.v * linear, share.w * angular))
                button = gui.add_button(label, hint="drives while it is held")
                button.on_hold(hold, callback_hz=RATE)
                button.on_click(self._on_release)  # over its button; if released elsewhere, the requests just stop
                command = gui.add_command(label, hotkey=key, description="drives while the key is held")
                command.on_trigger(hold)
        context.server.on_client_disconnect(self._on_release)
        rospy.on_shutdown(self.end)
        threading.Thread(target=self._run, daemon=True).start()

    def _holder(self, twist: Twist2D) -> Callable[[Any], Any]:
        # Coroutines run one after the other in viser's event loop; functions would run in its thread pool, where a late
        # request could overtake the release.
        async def hold(event: Any) -> None:
            self.drive(event.client_id, twist)

        return hold

    async def _on_release(self, event: Any) -> None:
        with self._wake:
            self._dead_man.release(event.client_id)
            self._wake.notify()

    def drive(self, page: int, twist: Twist2D) -> None:
        """Drive the selected robot; a goal is cancelled, or the server would go on commanding the robot as well."""
        state = self.context.state.now
        if not state.can_send:
            return
        with self._wake:
            begins = self._dead_man.request(page, state.selected, twist, time.monotonic())
            self._wake.notify()
        if begins and state.answering and state.executing is not False:
            cancel(self.context.requests)

    def stop(self) -> None:
        """Stop now, whichever page is driving."""
        with self._wake:
            self._dead_man.stop()
            self._wake.notify()

    def end(self) -> None:
        """Before topics are closed: stop the robot that is being driven, and wait until that has been sent."""
        self.stop()
        wait_until(lambda: not self._dead_man.active, END_TIMEOUT)

    def _run(self) -> None:
        publishers: Dict[str, rospy.Publisher] = {}  # by robot
        used = 0.0  # [s, wall] when the last command was sent
        while True:
            with self._wake:
                self._wake.wait(PERIOD if self._dead_man.active else IDLE_TIMEOUT if publishers else None)
                command = self._dead_man.command(time.monotonic())
            if command is not None:
                used = time.monotonic()
                if command.robot not in publishers:
                    topic = absolute(command.robot, "cmd_vel")
                    publishers[command.robot] = rospy.Publisher(topic, Twist, queue_size=1)
                with contextlib.suppress(rospy.ROSException):  # the node is shutting down
                    publishers[command.robot].publish(convert.to_twist_msg(command.twist))
            elif time.monotonic() - used >= IDLE_TIMEOUT:
                while publishers:
                    publishers.popitem()[1].unregister()
