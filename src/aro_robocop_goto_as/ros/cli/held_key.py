"""Tells which key is held down; terminals report presses and their repetition, but no releases."""

FIRST_REPEAT = 0.8  # [s] a held key repeats first after 0.25 s (console) to 0.66 s (X server, `xset q`)
NEXT_REPEAT = 0.3  # [s] and then 10 to 30 times a second, less evenly over a slow connection


class HeldKey:
    """The last key that was pressed, for as long as its repetition shows that it is held."""

    def __init__(self) -> None:
        self._key = ""
        self._until = 0.0  # [s]

    def press(self, key: str, now: float) -> None:
        """A key was pressed or has repeated, at a time [s]."""
        repeats = key == self.at(now)
        self._key, self._until = key, now + (NEXT_REPEAT if repeats else FIRST_REPEAT)

    def release(self) -> None:
        """No key counts as held from now on."""
        self._key = ""

    def at(self, now: float) -> str:
        """The key that is held at a time [s]; empty if none is."""
        return self._key if now < self._until else ""
