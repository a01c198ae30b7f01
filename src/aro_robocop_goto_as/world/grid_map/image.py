"""Read a map's image into the bytes that SDL_image, with which map_server loads images, has in memory."""

import os
import re
from typing import Any

import numpy as np

from ...errors import WorldError

PNG_MAX_COMPRESSION = 1032  # deflate's largest compression ratio (zlib.net, "zlib Technical Details")
_CHANNELS = {b"1": 1, b"2": 1, b"3": 3, b"4": 1, b"5": 1, b"6": 3}  # by the digit of a PNM file's magic number
_PLAIN = (b"1", b"2", b"3")
_GAP = rb"(?:\s|#[^\n]*\n)+"
_PNM = re.compile(
    rb"P([14])" + 2 * (_GAP + rb"(\d+)") + rb"(?:\s|$)()|P([2356])" + 3 * (_GAP + rb"(\d+)") + rb"(?:\s|$)"
)


def read_image(path: str) -> np.ndarray:
    """The pixels of a PNG or PNM file (PBM, PGM, PPM): (rows, columns, channels) uint8, the first row on top.

    One channel for grey, three for colours, four with alpha. 16 bits are reduced to 8. WorldError if the image can't be
    read, or if its header claims more pixels than the file can hold or Pillow accepts; that is found before memory is
    allocated for them.
    """
    from PIL import Image  # imported late: only maps need it

    try:
        with open(path, "rb") as file:
            content = file.read() if re.match(rb"P[1-6][\s#]", file.read(3)) and not file.seek(0) else b""
        if content:
            return _read_pnm(content, path, 2 * (Image.MAX_IMAGE_PIXELS or 0))
        with Image.open(path) as image:
            if image.format != "PNG":
                raise WorldError(f"{path}: a {image.format} image; supported: PGM, PNG")
            # Pillow would allocate memory for all pixels that the header claims.
            bits = 8 * (os.path.getsize(path) - image.tile[0][2]) * PNG_MAX_COMPRESSION
            _require_capacity(path, image.width, image.height, bits)
            return _channels(image)
    except Image.DecompressionBombError as exc:
        raise _too_large(path, str(exc), 2 * (Image.MAX_IMAGE_PIXELS or 0)) from exc
    except (OSError, SyntaxError, ValueError) as exc:
        raise WorldError(f"{path}: not a PGM or PNG image that can be read: {exc}") from exc


def _too_large(path: str, size: str, limit: int) -> WorldError:
    return WorldError(f"{path}: the header claims too large an image ({size}); expected no more than {limit} pixels")


def _require_capacity(path: str, width: int, height: int, capacity: int) -> None:
    if width * height > capacity:
        raise WorldError(
            f"{path}: the header claims {width} x {height} pixels, expected no more than "
            f"the {capacity} that the file can hold"
        )


def _channels(image: Any) -> np.ndarray:
    """A Pillow image as (rows, columns, channels) uint8; of 16 bits the upper 8 are kept."""
    if image.mode.startswith("I"):
        return (np.asarray(image).astype(np.uint32) >> 8).astype(np.uint8)[..., None]
    if image.mode in ("1", "L"):
        return np.asarray(image.convert("L"))[..., None]
    transparent = image.mode in ("LA", "PA", "RGBA") or "transparency" in image.info
    return np.asarray(image.convert("RGBA" if transparent else "RGB"))


def _read_pnm(content: bytes, path: str, limit: int) -> np.ndarray:
    """The pixels of a PNM file, scaled from 0..maximum to 0..255 and rounded down."""
    header = _PNM.match(content)
    if header is None:
        raise WorldError(f"{path}: not a PGM or PNG image that can be read: expected P2 or P5, width, height, maximum")
    kind, width, height, maximum = (text for text in header.groups() if text is not None)
    columns, rows, most = int(width), int(height), int(maximum or 255)
    if not 0 < most < 2**16 or not columns * rows:
        raise WorldError(f"{path}: not a PGM or PNG image that can be read: {columns} x {rows} pixels up to {most}")
    if columns * rows > limit:
        raise _too_large(path, f"{columns * rows} pixels", limit)
    channels = _CHANNELS[kind]
    body = content[header.end() :]
    values = _plain_values if kind in _PLAIN else _binary_values
    found = values(body, kind, columns, rows, most)
    _require_capacity(path, columns, rows, len(found) // channels)
    pixels = found[: rows * columns * channels].reshape(rows, columns, channels)
    return pixels.astype(np.uint8) if most == 255 else (pixels.astype(np.uint32) * 255 // most).astype(np.uint8)


def _plain_values(body: bytes, kind: bytes, columns: int, rows: int, most: int) -> np.ndarray:
    """The values of a plain file, as many as there are; PBM's 1 is black and needs no blanks."""
    body = re.sub(rb"#[^\n]*", b" ", body)
    if kind == b"1":
        digits = np.frombuffer(body, np.uint8)
        return np.where(digits[(digits == ord("0")) | (digits == ord("1"))] == ord("0"), 255, 0)
    if re.search(rb"[^\d\s]", body):
        raise ValueError("a plain PNM file holds digits and blanks only")
    return np.minimum(np.fromstring(body, np.int64, sep=" ") if body.strip() else np.zeros(0, np.int64), most)


def _binary_values(body: bytes, kind: bytes, columns: int, rows: int, most: int) -> np.ndarray:
    """The values of a binary file, as many as there are; a row of PBM's bits, 1 for black, fills whole bytes."""
    if kind == b"4":
        stride = -(-columns // 8)
        whole = len(body) // stride
        bits = np.unpackbits(np.frombuffer(body[: min(whole, rows) * stride], np.uint8)).reshape(-1, 8 * stride)
        return np.where(bits[:, :columns].ravel() == 0, 255, 0)
    if most > 255:
        return np.frombuffer(body[: len(body) // 2 * 2], ">u2")
    return np.minimum(np.frombuffer(body, np.uint8), most)
