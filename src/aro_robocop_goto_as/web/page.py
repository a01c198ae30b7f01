"""The page before it shows anything: its colours, where its cameras are, and which point of the floor they show."""

import math
from typing import Any, Dict, Iterable, Optional, Tuple

import numpy as np

from ..geometry import Vector3

CAMERA, LOOK_AT, FIELD = (0.5, -6.6, 6.8), (0.5, -0.2, 0.0), 0.75  # [m] in the fixed frame, [rad]; shows ROOM
ROOM = 5.0  # [m] along both sides, its middle in the origin
FARTHEST_SHOWN = 10.0  # [m] from the origin, along x and y, at first; farther away a robot would be a few pixels
PHONE = 576  # [pixel] of width, below which viser shows the panel at the bottom
PHONE_LOOK_AT = (0.0, -3.4, 0.0)  # [m], as the panel covers the lower part
PHONE_AWAY = 0.75  # of CAMERA's distance, in a view that is as wide as it is high
# viser's panel is as wide on a phone as elsewhere, and covers more than half of it.
STYLE = """<style>
@media (max-width: 36em) {
  div[style*="max-height: 60%"] { max-height: 45% !important; }
  div[style*="max-height: 60%"], div[style*="max-height: 60%"] div[style*="width: 20em"] { width: 100% !important; }
}
</style>"""
FLOOR_SIZE = 40.0  # [m] of the grid
FLOOR: Dict[bool, Dict[str, Tuple[int, int, int]]] = {  # its colours by whether the theme is dark
    False: {"plane_color": (246, 247, 249), "cell_color": (222, 226, 230), "section_color": (190, 197, 205)},
    True: {"plane_color": (34, 38, 46), "cell_color": (62, 68, 80), "section_color": (95, 103, 118)},
}
FARTHEST_CLICK = 1000.0  # [m] from the scene's origin; a ray that almost misses the floor meets it somewhere beyond
SUN = (-3.0, -5.0, 9.0)  # [m] where the light comes from: the left of the first view


def set_up(server: Any) -> None:
    """Prepare the page of a viser server.

    viser's own lights come from a picture that a browser without a graphics card needs minutes for, and until then it
    shows the scene at a twentieth of its brightness.
    """
    scene, camera = server.scene, server.initial_camera
    scene.set_up_direction("+z")
    scene.configure_environment_map(None)
    scene.configure_default_lights(False)
    scene.add_light_ambient("/light/everywhere", intensity=1.6)
    scene.add_light_directional("/light/sun", intensity=1.8, position=SUN)
    camera.position, camera.look_at, camera.fov = CAMERA, LOOK_AT, FIELD
    server.gui.add_html(STYLE)
    server.on_client_connect(lambda client: fit_view(client, camera))


def show_places(server: Any, places: Iterable[Vector3]) -> None:
    """Turn all cameras to the origin, where robots start, and these places [m]; they show ROOM or what is larger."""
    points = np.clip([(0.0, 0.0, 0.0), *places], -FARTHEST_SHOWN, FARTHEST_SHOWN)[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    scale, middle = max(1.0, float((high - low).max()) / ROOM), np.append((low + high) / 2.0, 0.0)
    position, look_at = middle + np.multiply(CAMERA, scale), middle + np.multiply(LOOK_AT, scale)
    camera = server.initial_camera
    if np.allclose([position, look_at], [camera.position, camera.look_at]):
        return  # such as the same world, drawn anew: a view that somebody has chosen stays
    camera.position, camera.look_at = position, look_at
    for client in server.get_clients().values():
        fit_view(client, camera)


def fit_view(client: Any, first: Any) -> None:
    """Show what the first camera shows, on a phone above the panel."""
    camera, position, look_at = client.camera, first.position, first.look_at
    if camera.image_width < PHONE:
        away = np.subtract(position, look_at)
        scale = np.linalg.norm(away) / np.linalg.norm(np.subtract(CAMERA, LOOK_AT))
        look_at = look_at + scale * np.subtract(PHONE_LOOK_AT, LOOK_AT)
        position = look_at + away * PHONE_AWAY / camera.aspect
    camera.position = position
    camera.look_at = look_at  # after the position, which moves it as well


def set_theme(server: Any, dark: bool) -> None:
    """Show panel and floor in dark or light colours."""
    server.gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False, control_width="medium")
    opaque = {"plane_opacity": 1.0, "shadow_opacity": 0.0}
    server.scene.add_grid("/floor", FLOOR_SIZE, FLOOR_SIZE, cell_size=0.5, section_size=1.0, **opaque, **FLOOR[dark])


def floor_point(origin: Vector3, direction: Vector3) -> Optional[Tuple[float, float]]:
    """Where the ray of a click meets the floor: x, y [m], or None if it does not, or too far away to be meant."""
    numbers = (*origin, *direction)
    if not all(math.isfinite(number) for number in numbers) or direction[2] * origin[2] >= 0.0:
        return None
    distance = -origin[2] / direction[2]
    x, y = origin[0] + distance * direction[0], origin[1] + distance * direction[1]
    return (x, y) if math.hypot(x, y) <= FARTHEST_CLICK else None
