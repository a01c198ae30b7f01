"""The surroundings of the robots: the simulator's and the server's markers, the scan and the map."""

from dataclasses import replace
from typing import Any, Optional

import numpy as np
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan
from visualization_msgs.msg import MarkerArray

from ...geometry import Pose3D, compose3, rotation_matrix
from ...names import SERVER, SIMULATOR, absolute
from ...web.page import BrowserCameras
from ...web.scene import IMAGE, POINTS, Visual
from ...web.state import PageState
from ..marker_shapes import MarkerStore, to_pose
from .part import Context, Inbox, Part

DRAWN_BY_MODEL = ("robots", "noses")  # the simulator's markers for robots; the page draws their models instead
DRAWN_BY_PAGE = ("trail",)  # markers of the server that the page draws itself, for any server
SCAN = Visual(POINTS, (0.025, 0.025, 0.025), (255, 85, 70))
PATIENCE = 1.0  # [s] between the stamps of a scan that waits for its transform and of one that takes its place
MAP_HEIGHT = 0.003  # [m] above the grid, below goal and trail
MAX_MAP_CELLS = 2000  # cells along a side; larger maps are thinned out
UNKNOWN, FREE, OCCUPIED = (90, 95, 105, 120), (205, 210, 216, 60), (20, 22, 26, 255)  # red, green, blue, opacity


class SceneryPart(Part):
    """Scan and map wait until their frames are known, and are drawn once."""

    def __init__(self, context: Context, cameras: BrowserCameras) -> None:
        super().__init__(context)
        self._cameras = cameras
        self._world, self._server = MarkerStore(), MarkerStore()
        self._scan: Optional[LaserScan] = None  # that is not drawn yet, as the map
        self._map: Optional[OccupancyGrid] = None
        self._robot = ""

    def subscribe(self, inbox: Inbox) -> None:
        self._world = MarkerStore()
        inbox.subscribe(absolute(SIMULATOR, "world"), MarkerArray, lambda _, message: self._world.apply(message), None)
        inbox.subscribe("/map", OccupancyGrid, self._on_map)

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        self._server, self._scan = MarkerStore(), None
        if robot != self._robot:
            self._robot = robot
            self.context.scene.show("scan", {})
        markers = absolute(robot, f"{SERVER}/markers")
        inbox.subscribe(markers, MarkerArray, lambda _, message: self._server.apply(message), None)
        inbox.subscribe(absolute(robot, "scan"), LaserScan, self._on_scan)

    def _on_map(self, _: float, message: OccupancyGrid) -> None:
        self._map = message

    def _on_scan(self, _: float, message: LaserScan) -> None:
        waiting = self._scan
        if waiting is None or abs((message.header.stamp - waiting.header.stamp).to_sec()) > PATIENCE:
            self._scan = message

    def show(self, state: PageState) -> None:
        scene, locate = self.context.scene, self.context.locate
        without_robots = self._world.placed(locate, DRAWN_BY_MODEL)
        if without_robots and not scene.draws("world"):
            self._cameras.show(pose.position for _, pose in without_robots.values())
        world = without_robots if scene.draws("robots") else self._world.placed(locate)
        scene.show("world", world)
        scene.show("server", self._server.placed(locate, DRAWN_BY_PAGE))
        pose = None if self._scan is None else locate(self._scan.header.frame_id, self._scan.header.stamp)
        if self._scan is not None and pose is not None:  # the scan stays where its robot was when it was measured
            # In the scene's frame: a slow browser moves a shape some time before it draws the shape's new points.
            rows: Any = scan_points(self._scan) @ rotation_matrix(pose.orientation).T + pose.position
            points = tuple((x, y, z) for x, y, z in rows.tolist())
            scene.show("scan", {"scan": (replace(SCAN, points=points), Pose3D())} if points else {})
            self._scan = None
        pose = None if self._map is None else locate(self._map.header.frame_id)
        if self._map is not None and pose is not None:
            self._draw_map(self._map, pose)
            self._map = None

    def _draw_map(self, message: OccupancyGrid, fixed_from_map: Pose3D) -> None:
        info = message.info
        origin = to_pose(info.origin.position, info.origin.orientation)
        if origin is not None and info.width and len(message.data) == info.width * info.height:
            width, height = info.width * info.resolution, info.height * info.resolution
            half = Pose3D((width / 2.0, height / 2.0, MAP_HEIGHT))
            image = Visual(IMAGE, (width, height, 0.0), image=map_image(message.data, info.width, info.height))
            self.context.scene.show("map", {object(): (image, compose3(compose3(fixed_from_map, origin), half))})


def scan_points(scan: LaserScan) -> np.ndarray:
    """Points (n, 3) [m] of the valid returns, in the scanner's frame."""
    ranges = np.array(scan.ranges, dtype=float)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    with np.errstate(invalid="ignore"):
        valid = np.isfinite(ranges) & (ranges >= scan.range_min) & (ranges <= scan.range_max) & (ranges > 0.0)
    ranges, angles = ranges[valid], angles[valid]
    return np.stack([ranges * np.cos(angles), ranges * np.sin(angles), np.zeros(len(ranges))], axis=1)


def map_image(data: Any, columns: int, rows: int) -> np.ndarray:
    """Cells of an occupancy grid, row by row from its origin -> an image (rows, columns, 4).

    The first row has the lowest y in both: viser's images have x to the right and y down, as cameras do.
    """
    cells = np.array(data, dtype=np.int16).reshape(rows, columns)
    stride = -(-max(rows, columns) // MAX_MAP_CELLS)
    cells = cells[::stride, ::stride]
    share = np.clip(cells, 0, 100)[..., np.newaxis] / 100.0
    image = np.array(FREE) * (1.0 - share) + np.array(OCCUPIED) * share
    image[cells < 0] = UNKNOWN
    return image.astype(np.uint8)
