"""Camera images as arrays."""

import pytest
from sensor_msgs.msg import Image

from aro_robocop_goto_as.ros.web.view import camera_image


@pytest.mark.parametrize(
    "encoding, data, pixel",
    [("rgb8", b"\1\2\3", (1, 2, 3)), ("bgr8", b"\1\2\3", (3, 2, 1)), ("mono8", b"\7", (7, 7, 7))],
)
def test_an_image_is_shown_in_colour_without_the_filling_of_its_rows(encoding, data, pixel):
    image = camera_image(Image(height=2, width=1, step=len(data) + 1, encoding=encoding, data=2 * (data + b"\0")))
    assert image.tolist() == [[list(pixel)], [list(pixel)]]


@pytest.mark.parametrize("change", [{"encoding": "32FC1"}, {"step": 2}, {"data": b"\0\0"}])
def test_an_image_of_another_encoding_or_size_is_not_shown(change):
    assert (
        camera_image(Image(**{"height": 1, "width": 1, "step": 3, "encoding": "rgb8", "data": b"\0" * 3, **change}))
        is None
    )
