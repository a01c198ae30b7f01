"""Read a map's image into the bytes that SDL_image, with which map_server loads images, has in memory."""

import os
from typing import Any

import numpy as np

from ...errors import WorldError
from ...reading import reading

SUPPORTED = "PGM, PNG or BMP"
_FORMATS = ("BMP", "PNG", "PPM")  # as Pillow names them; PPM is every kind of PNM: PBM, PGM, PPM, plain or binary
_MAX_COMPRESSION = 1032  # deflate's largest compression ratio (zlib.net, "zlib Technical Details"), that is PNG's


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
