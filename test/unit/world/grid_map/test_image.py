"""Images of maps are read as by SDL_image, and refused before they take memory."""

import numpy as np
import pytest
from map_files import write_yaml, yaml_of
from PIL import Image

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.grid_map.image import read_image
from aro_robocop_goto_as.world.load import load_world


@pytest.mark.parametrize("name, depth", [("m.pgm", 1), ("m.png", 1), ("m.bmp", 1), ("m16.png", 257)])
def test_pgm_png_and_bmp_of_8_and_16_bits_have_the_pixels_that_were_written(tmp_path, name, depth):
    pixels = np.array([[0, 1, 128], [205, 254, 255]], np.uint8 if depth == 1 else np.uint16)
    Image.fromarray(pixels * pixels.dtype.type(depth)).save(str(tmp_path / name))
    assert read_image(str(tmp_path / name))[..., 0].tolist() == pixels.tolist()


PNM = {  # bytes of a 3 x 2 image: its pixels by SDL_image's arithmetic, rows from the top
    b"P1 3 2\n010 1#no\n10": [[255, 0, 255], [0, 0, 255]],
    b"P4\n3 2\n\x40\xdf": [[255, 0, 255], [0, 0, 255]],
    b"P2 3 2 255 0 1 2 # two\n 253 254 255": [[0, 1, 2], [253, 254, 255]],
    b"P2 3 2 100 0 1 50 77 99 100": [[0, 2, 127], [196, 252, 255]],
    b"P5\n#a\n3 2\n#b\n100\n\x00\x01\x32\x4d\x63\x64": [[0, 2, 127], [196, 252, 255]],
    b"P5 3 2 65535\n\x00\x00\x00\xff\x01\x01\xfe\xff\xff\x00\xff\xff": [[0, 0, 1], [254, 255, 255]],
    b"P3 3 2 255 " + b"7 8 9 " * 6: [[[7, 8, 9]] * 3] * 2,
    b"P6 3 2 255\n" + b"\x07\x08\x09" * 6: [[[7, 8, 9]] * 3] * 2,
    b"P6 3 2 15\n" + b"\x0f\x07\x00" * 6: [[[255, 119, 0]] * 3] * 2,
}


@pytest.mark.parametrize("content", PNM)
def test_every_kind_of_pnm_is_read_as_by_map_servers_image_loader(tmp_path, content):
    (tmp_path / "m.pnm").write_bytes(content)
    assert read_image(str(tmp_path / "m.pnm")).squeeze(-1 if content[1:2] not in b"36" else ()).tolist() == PNM[content]


@pytest.mark.parametrize(
    "content",
    [
        b"P5 3 0 255\n",
        b"P5 3 2 0\n123456",
        b"P5 3 2 99999\n123456",
        b"P2 3 2 255 1 2 3 a b c",
        b"P5 20 20 255\n" + bytes(399),
        b"P2 20 20 255\n" + b"254 " * 399,
        b"BM",
        b"",
    ],
)
def test_image_without_pixels_or_maximum_or_numbers_is_refused(tmp_path, content):
    (tmp_path / "m.pnm").write_bytes(content)
    with pytest.raises(WorldError, match="m.pnm: .+; expected a PGM, PNG or BMP image"):
        read_image(str(tmp_path / "m.pnm"))


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"P5 100000 100000 255\n0", r"Image size \(10000000000 pixels\) exceeds limit of .*; expected a PGM"),
        (b"P5 9000 9000 255\n0", "the header claims 9000 x 9000 pixels, expected no more than the 148608 that"),
        (b"P2 9000 9000 255\n1 2 3", "the header claims 9000 x 9000 pixels, expected no more than the 181632 that"),
    ],
)
def test_image_that_claims_too_much_is_refused_before_memory_is_allocated(tmp_path, content, problem, monkeypatch):
    def loaded(_image):
        raise AssertionError("the pixels were decoded")

    (tmp_path / "m.pgm").write_bytes(content)
    monkeypatch.setattr(Image.Image, "load", loaded)
    with pytest.raises(WorldError, match=f"^{tmp_path}/m.pgm: {problem}"):
        load_world(write_yaml(tmp_path, yaml_of()))
