"""The buttons and keys that drive a robot while they are held."""

from typing import Any, Callable

from ..geometry import Twist2D

HOLD_RATE = 10.0  # [Hz] at which a page renews the request of a button that is held
PAD = (
    # label, hot key, icon, forward, counter-clockwise
    ("Forward (I)", "I", "ARROW_UP", 1.0, 0.0),
    ("Turn left (J)", "J", "ARROW_BACK_UP", 0.0, 1.0),
    ("Turn right (L)", "L", "ARROW_FORWARD_UP", 0.0, -1.0),
    ("Backward (K)", "K", "ARROW_DOWN", -1.0, 0.0),
)
Drive = Callable[[int, Twist2D], None]  # page, velocity as a share of the full speed, -1 to 1
Release = Callable[[int], None]  # page


def add_drive_pad(gui: Any, icons: Any, drive: Drive, release: Release) -> None:
    """Add the pad to the panel `gui` of a viser server."""

    def holder(share: Twist2D) -> Callable[[Any], Any]:
        # Coroutines run one after the other in viser's event loop; functions would run in its thread pool, where a late
        # request could overtake the release.
        async def hold(event: Any) -> None:
            drive(event.client_id, share)

        return hold

    async def on_release(event: Any) -> None:
        """The pointer was released over its button of the pad; if released elsewhere, the requests just stop."""
        release(event.client_id)

    for label, key, icon, forward, turn in PAD:
        share = Twist2D(forward, turn)
        button = gui.add_button(label, icon=getattr(icons, icon), hint="drives while it is held")
        button.on_hold(holder(share), callback_hz=HOLD_RATE)
        button.on_click(on_release)
        command = gui.add_command(label, hotkey=key, description="drives while the key is held")
        command.on_trigger(holder(share))
