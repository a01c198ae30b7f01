"""The cells of a map's image, by the arithmetic of map_server."""

import numpy as np

from .image import read_image
from .map_file import MapSpec


def read_cells(spec: MapSpec) -> np.ndarray:
    """A map's image as the cells that map_server would publish: (rows, columns) int8, the image's last row first.

    -1 unknown, 0 free to 100 occupied; in mode raw whatever the image holds. WorldError as read_image.
    """
    pixels = read_image(spec.image)
    if pixels.shape[-1] == 1:  # the usual map: look the 256 greys up in a table
        cells = _cells(np.arange(256, dtype=np.uint8)[:, None], spec)[pixels[..., 0]]
    else:
        cells = _cells(pixels, spec)
    return np.ascontiguousarray(cells[::-1])


def _cells(pixels: np.ndarray, spec: MapSpec) -> np.ndarray:
    """Cell values (...) int8 of pixels (..., channels) uint8, as in map_server's image_loader.

    In mode trinary all channels are averaged, alpha included. In other modes the last of several channels is left
    out. In mode scale a pixel between the thresholds that is not opaque is unknown, as wiki.ros.org/map_server
    documents. In map_server, the last of three channels counts as alpha as well; there, such a pixel is unknown if
    this channel is 0.
    """
    shaded = spec.mode != "trinary" and pixels.shape[-1] > 1
    greys = (pixels[..., :-1] if shaded else pixels).mean(axis=-1)
    if spec.negate:
        greys = 255.0 - greys
    if spec.mode == "raw":
        return greys.astype(np.uint8).view(np.int8)  # values above 127 become negative
    occupied = (255.0 - greys) / 255.0
    between = np.full(greys.shape, -1.0)
    if spec.mode == "scale":
        span = max(spec.occupied_thresh - spec.free_thresh, 1e-9)
        between = np.floor(1.0 + 98.0 * ((occupied - spec.free_thresh) / span))
        if shaded:
            between[pixels[..., -1] < (255 if pixels.shape[-1] == 4 else 1)] = -1.0
    cells = np.where(occupied > spec.occupied_thresh, 100.0, np.where(occupied < spec.free_thresh, 0.0, between))
    return cells.astype(np.int8)
