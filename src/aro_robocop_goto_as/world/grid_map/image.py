"""Read a map's image into cells: its pixels as SDL_image has them, their values by map_server's arithmetic."""

import os
from typing import Any

import numpy as np

from ...errors import WorldError
from ...reading import reading
from .map_file import SUPPORTED, MapSpec

_FORMATS = ("BMP", "PNG", "PPM")  # as Pillow names them; PPM is every kind of PNM: PBM, PGM, PPM, plain or binary
_MAX_COMPRESSION = 1032  # deflate's largest compression ratio (zlib.net, "zlib Technical Details"), that is PNG's


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


def read_image(path: str) -> np.ndarray:
    """The pixels of a PNM, PNG or BMP file: (rows, columns, channels) uint8, the first row on top.

    One channel for grey, three for colours, four with alpha. 16 bits are reduced to 8. WorldError if the image can't be
    read, or if its header claims more pixels than the file can hold or Pillow accepts; that is found before memory is
    allocated for them.
    """
    from PIL import Image  # imported late: only maps need it

    with reading(path, WorldError, f"a {SUPPORTED} image"), Image.open(path) as image:
        if image.format not in _FORMATS:
            raise WorldError(f"{path}: a {image.format} image, expected a {SUPPORTED} image")
        capacity = 8 * _MAX_COMPRESSION * os.path.getsize(path)  # of pixels of one bit
        if image.width * image.height > capacity:
            raise WorldError(
                f"{path}: the header claims {image.width} x {image.height} pixels, expected no more than "
                f"the {capacity} that the file can hold"
            )
        return _channels(image)


def _channels(image: Any) -> np.ndarray:
    """A Pillow image as (rows, columns, channels) uint8; of 16 bits the upper 8 are kept."""
    decoder, _, _, arguments = image.tile[0]
    maximum = arguments[-1] if decoder in ("ppm", "ppm_plain") else None  # no number for bitmaps
    if image.mode.startswith("I"):
        return (np.asarray(image).astype(np.uint32) >> 8).astype(np.uint8)[..., None]
    if image.mode in ("1", "L"):
        pixels = np.asarray(image.convert("L"))[..., None]
    else:
        transparent = image.mode in ("LA", "PA", "RGBA") or "transparency" in image.info
        pixels = np.asarray(image.convert("RGBA" if transparent else "RGB"))
    if (
        isinstance(maximum, int) and maximum < 255
    ):  # Pillow has scaled the file's values to 0..255 and rounded them; SDL_image rounds down
        values = np.rint(pixels * (maximum / 255.0)).astype(np.uint32)
        pixels = (values * 255 // maximum).astype(np.uint8)
    return pixels
