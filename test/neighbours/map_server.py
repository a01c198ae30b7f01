#!/usr/bin/env python3
"""As map_server: a map's YAML file -> the latched topics map and map_metadata, and the service static_map.

Usage: map_server.py FILE
"""

import sys
from pathlib import Path

import numpy as np
import rospy
import yaml
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse
from PIL import Image


def read_map(file):
    """The OccupancyGrid of a YAML file, in its mode trinary."""
    entries = yaml.safe_load(file.read_text())
    shades = np.asarray(Image.open(file.parent / entries["image"]).convert("L"), float)[::-1]
    darkness = (shades if entries["negate"] else 255.0 - shades) / 255.0
    cells = np.full(shades.shape, -1, np.int8)
    cells[darkness > entries["occupied_thresh"]] = 100
    cells[darkness < entries["free_thresh"]] = 0
    grid = OccupancyGrid()
    grid.header.frame_id = "map"
    grid.info.resolution = entries["resolution"]
    grid.info.height, grid.info.width = cells.shape
    grid.info.origin.position.x, grid.info.origin.position.y = entries["origin"][:2]
    grid.info.origin.orientation.w = 1.0
    grid.data = cells.ravel().tolist()
    return grid


def main():
    """Serve the map."""
    rospy.init_node("map_server")
    grid = read_map(Path(rospy.myargv()[1]))
    grid.header.stamp = grid.info.map_load_time = rospy.Time.now()
    rospy.Service("static_map", GetMap, lambda request: GetMapResponse(grid))
    rospy.Publisher("map_metadata", MapMetaData, queue_size=1, latch=True).publish(grid.info)
    rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True).publish(grid)
    rospy.spin()


if __name__ == "__main__":
    sys.exit(main())
