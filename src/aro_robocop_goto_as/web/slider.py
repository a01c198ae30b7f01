"""A slider of the panel."""

import time
from typing import Any, Callable

SETTLED = 2.0  # [s, wall] after a visitor has moved a slider: until then what is reported may be older than that
Mover = Callable[[float], None]


class Slider:
    """A slider that visitors move, and that otherwise follows what is reported."""

    def __init__(self, gui: Any, label: str, high: float, start: float, hint: str, moved: Mover, low: float = 0.1):
        """`moved` is called with the value that a visitor has chosen, a multiple of 0.1."""
        self._handle = gui.add_slider(label, low, high, 0.1, start, hint=hint)
        self._moved_at = 0.0  # [s, wall]

        async def on_update(event: Any) -> None:  # a coroutine: in viser's thread pool it could come late
            if event.client is not None:
                self._moved_at = time.monotonic()
                moved(event.target.value)

        self._handle.on_update(on_update)

    def show(self, value: float) -> None:
        """Show the value within the bounds, unless a visitor's own may still be on its way."""
        value = min(max(value, self._handle.min), self._handle.max)
        if time.monotonic() - self._moved_at > SETTLED:
            self._handle.value = value
