"""The part of the X screen that a window may fill."""

import ctypes
from typing import List, NamedTuple, Optional

CARDINAL = 6  # the type of _NET_WORKAREA, as in X11/Xatom.h
DECORATION = 40  # [pixel] for a window manager's title bar


class Area(NamedTuple):
    """A rectangle of the screen [pixel], x to the right and y down from the upper left corner."""

    x: int
    y: int
    width: int
    height: int

    def common(self, other: "Area") -> "Area":
        """The part that two areas have in common."""
        x, y = max(self.x, other.x), max(self.y, other.y)
        right = min(self.x + self.width, other.x + other.width)
        bottom = min(self.y + self.height, other.y + other.height)
        return Area(x, y, max(right - x, 0), max(bottom - y, 0))


class _Monitor(ctypes.Structure):
    """XineramaScreenInfo, as in X11/extensions/Xinerama.h."""

    _fields_ = [("number", ctypes.c_int)] + [(name, ctypes.c_short) for name in ("x", "y", "width", "height")]


def window_area() -> Optional[Area]:
    """What a window may fill: the first monitor, without panels and the title bar; None if no X server answers."""
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return None
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        return None
    try:
        screen = x11.XDefaultScreen(display)
        area = Area(0, 0, x11.XDisplayWidth(display, screen), x11.XDisplayHeight(display, screen))
        area = area.common(_first_monitor(display) or area)
        work_area = _work_area(x11, display)
    finally:
        x11.XCloseDisplay(display)
    if work_area is None:
        return area
    area = area.common(work_area)
    return area._replace(height=area.height - DECORATION)


def _first_monitor(display: ctypes.c_void_p) -> Optional[Area]:
    """The primary monitor, which X servers list first; None if they list none."""
    try:
        xinerama = ctypes.CDLL("libXinerama.so.1")
    except OSError:
        return None
    xinerama.XineramaQueryScreens.restype = ctypes.POINTER(_Monitor)
    count = ctypes.c_int()
    monitors = xinerama.XineramaQueryScreens(display, ctypes.byref(count))
    if not monitors or count.value < 1:
        return None
    first = monitors[0]
    return Area(first.x, first.y, first.width, first.height)


def _work_area(x11: ctypes.CDLL, display: ctypes.c_void_p) -> Optional[Area]:
    """The screen without panels, which window managers publish as _NET_WORKAREA (EWMH); None if there is none."""
    atom = x11.XInternAtom(display, b"_NET_WORKAREA", True)
    if not atom:
        return None
    x11.XDefaultRootWindow.restype = ctypes.c_ulong
    kind, left = ctypes.c_ulong(), ctypes.c_ulong()
    form, count = ctypes.c_int(), ctypes.c_ulong()
    data = ctypes.POINTER(ctypes.c_long)()
    root, lengths = ctypes.c_ulong(x11.XDefaultRootWindow(display)), (ctypes.c_long(0), ctypes.c_long(4))
    results = [ctypes.byref(result) for result in (kind, form, count, left, data)]
    failed = x11.XGetWindowProperty(
        display, root, ctypes.c_ulong(atom), *lengths, False, ctypes.c_ulong(CARDINAL), *results
    )
    if failed or count.value < 4:
        return None
    values: List[int] = [data[index] for index in range(4)]
    return Area(*values)
