"""The page before it shows anything: its colours, where its cameras are, and which point of the floor they show."""

import math
from typing import Any, Iterable, Optional, Tuple

import numpy as np

from ..geometry import Vector3

Axes = Tuple[np.ndarray, np.ndarray]  # of a camera: where it looks, and its upwards

FIELD = 0.75  # [rad] of the cameras' view from its lower to its upper edge
RIGHT = np.array((1.0, 0.0, 0.0))
STEEP, FLAT = 0.9, 0.6  # sine of the angle at which cameras look down, in a tall part of a window and in a wide one
ROOM, HEIGHT = 5.0, 0.4  # [m] along x and y, and along z, that are shown at least
MAX_SHOWN = 10.0  # [m] from the origin, along x and y, at first; farther away a robot would be a few pixels
DESK = 1.2  # width by height of the scene that "reset view" is made for
LOWEST = 0.2  # [m] above the floor of a camera that somebody turns
FILLED = 0.94  # share of the scene's width or height
# The panel is beside the scene, on a phone below it, so that it covers nothing: viser's covers more than half of a
# phone, and is as narrow there as elsewhere. And viser takes no notice of a press on its canvas that the canvas has
# captured, as browsers do by themselves for a finger: a tap was no click.
# A tab that is chosen is scrolled to the top of the panel, so that a low panel shows what is in it.
STYLE = """<style onload="window.addEventListener(
  'pointerdown', e => e.target.tagName === 'CANVAS' && e.target.releasePointerCapture(e.pointerId), true
), window.addEventListener('click', e => e.target.closest('[role=tab]')?.scrollIntoView())">
@media (max-width: 36em) {
  div:has(> div[style*="max-height: 60%"]) { flex-direction: column; }
  div:has(+ div[style*="max-height: 60%"]) { min-height: 0; }
  div[style*="max-height: 60%"] { position: static !important; flex: none; max-height: 50% !important; }
  div[style*="max-height: 60%"], div[style*="max-height: 60%"] div[style*="width: 20em"] { width: 100% !important; }
}
</style>"""
FLOOR_SIZE = 40.0  # [m] of the grid
FLOOR = {"plane_color": (246, 247, 249), "cell_color": (222, 226, 230), "section_color": (190, 197, 205)}
MAX_CLICK = 1000.0  # [m] from the scene's origin; a ray that almost misses the floor meets it somewhere beyond
SUN = (-3.0, -5.0, 9.0)  # [m] where the light comes from: the left of the first view


def set_up(server: Any) -> None:
    """Prepare the page of a viser server.

    viser's own lights come from a picture that a browser without a graphics card needs minutes for, and until then it
    shows the scene at a twentieth of its brightness.
    """
    scene = server.scene
    scene.set_up_direction("+z")
    scene.configure_environment_map(None)
    scene.configure_default_lights(False)
    scene.add_light_ambient("/light/everywhere", intensity=1.6)
    scene.add_light_directional("/light/sun", intensity=1.8, position=SUN)
    opaque = {"plane_opacity": 1.0, "shadow_opacity": 0.0}
    scene.add_grid("/floor", FLOOR_SIZE, FLOOR_SIZE, cell_size=0.5, section_size=1.0, **opaque, **FLOOR)
    server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
    server.gui.main_panel.dock_right()
    server.gui.add_html(STYLE)


class BrowserCameras:
    """The cameras of all browsers show the origin, where robots start, and ROOM or what is larger."""

    def __init__(self, server: Any) -> None:
        self._server = server
        self._corners = corners_of(())
        server.initial_camera.fov = FIELD
        self._set_first()
        server.on_client_connect(self._add)

    def show(self, places: Iterable[Vector3]) -> None:
        """Turn to the origin and these places [m], unless the cameras were turned to them: a chosen view then stays."""
        corners = corners_of(places)
        if not np.allclose(corners, self._corners):
            self._corners = corners
            self._set_first()
            for client in self._server.get_clients().values():
                self._turn(client.camera)

    def _set_first(self) -> None:
        first = self._server.initial_camera
        first.position, first.look_at = view_of(self._corners, DESK, axes_of(DESK), FIELD)

    def _add(self, client: Any) -> None:
        shown = self._turn(client.camera)

        def on_update(camera: Any) -> None:
            """Turn again after a slow browser's first view, after "reset view", or when the size has changed."""
            nonlocal shown
            if any(np.allclose(camera.position, known) for known in (shown, self._server.initial_camera.position)):
                shown = self._turn(camera)
            elif camera.position[2] < LOWEST:  # it was turned to below the floor, which hides everything
                (x, y, z), look_at = camera.position, camera.look_at
                camera.position = (x, y, max(-z, LOWEST))
                camera.look_at = look_at

        client.camera.on_update(on_update)

    def _turn(self, camera: Any) -> np.ndarray:
        """Show the corners; returns the camera's position."""
        width, height = camera.image_width, camera.image_height
        aspect = width / height if width and height else DESK  # a hidden page has no size
        position, look_at = view_of(self._corners, aspect, axes_of(aspect), FIELD)
        camera.position = position
        camera.look_at = look_at  # after the position, which moves it as well
        return position


def corners_of(places: Iterable[Vector3]) -> np.ndarray:
    """Corners (8, 3) [m] of a box around the origin and these places, as large as ROOM at least."""
    points = np.clip([(0.0, 0.0, 0.0), *places], -MAX_SHOWN, MAX_SHOWN)[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    half, middle = np.maximum((high - low) / 2.0, ROOM / 2.0), (low + high) / 2.0
    (left, near), (right, far) = middle - half, middle + half
    return np.array([(x, y, z) for x in (left, right) for y in (near, far) for z in (0.0, HEIGHT)])


def axes_of(aspect: float) -> Axes:
    """The axes of the page's cameras: x to the right, steeper down in a taller scene, which a room then fills."""
    down = min(max(1.2 / aspect, FLAT), STEEP)
    ahead = np.array((0.0, math.sqrt(1.0 - down**2), -down))
    return ahead, np.cross(RIGHT, ahead)


def view_of(corners: np.ndarray, aspect: float, axes: Axes, field: float) -> Tuple[np.ndarray, np.ndarray]:
    """The nearest camera that shows corners (n, 3) [m] in the middle of a scene; aspect: its width by its height.

    field: [rad] of its view from the lower to the upper edge
    Returns its position and the point of the floor in the middle of the scene [m].
    """
    look, above = axes
    half = FILLED * math.tan(field / 2.0)  # of what is filled, one metre ahead of the camera
    # A corner c is seen at ((c - p) @ RIGHT) / ((c - p) @ look) from a position p. So each edge of what is filled
    # limits p @ (RIGHT - edge * look), by the corner that is nearest to this edge; the same for `above`.
    limits = []
    for axis, edge in ((RIGHT, half * aspect), (above, half)):
        low, high = float((corners @ (axis + edge * look)).min()), float((corners @ (axis - edge * look)).max())
        limits.append((low, high, edge))
    ahead = min((low - high) / (2.0 * edge) for low, high, edge in limits)
    right, up = ((low + high) / 2.0 for low, high, _ in limits)
    position = right * RIGHT + up * above + ahead * look
    return position, position - position[2] / look[2] * look


def floor_point(origin: Vector3, direction: Vector3) -> Optional[Tuple[float, float]]:
    """Where the ray of a click meets the floor: x, y [m], or None if it does not, or too far away to be meant."""
    numbers = (*origin, *direction)
    if not all(math.isfinite(number) for number in numbers) or direction[2] * origin[2] >= 0.0:
        return None
    distance = -origin[2] / direction[2]
    x, y = origin[0] + distance * direction[0], origin[1] + distance * direction[1]
    return (x, y) if math.hypot(x, y) <= MAX_CLICK else None
