"""An HTML element of the page's panel."""

from typing import Any


class Html:
    """An element that is sent when its content changes, and hidden while that is empty."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self._content = ""

    def show(self, content: str) -> None:
        """Show this HTML."""
        if content != self._content:
            self._handle.content = self._content = content
            self._handle.visible = bool(content)
