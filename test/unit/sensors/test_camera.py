"""The image geometry of a camera: pixels, rays and depths."""

import math

import numpy as np
import pytest

from aro_robocop_goto_as.sensors.camera import CameraSpec, depth_of, points_of, projection


def test_pixel_centres_lie_on_the_rays_of_the_calibration() -> None:
    spec = CameraSpec(4, 2, math.pi / 2.0, 0.5, 8.0)
    assert (spec.focal, spec.centre_x, spec.centre_y) == (pytest.approx(2.0), 1.5, 0.5)
    points = points_of(np.full((2, 4), 2.0, np.float32), spec)
    assert points[0, 0] == pytest.approx([-1.5, -0.5, 2.0])
    assert points[1, 3] == pytest.approx([1.5, 0.5, 2.0])
    # The projection maps the nearest and farthest depth to the two ends of the depth buffer.
    matrix = np.array(projection(spec)).reshape(4, 4).T
    for depth, end in ((0.5, 0.0), (8.0, 1.0)):
        clip = matrix @ [0.0, 0.0, -depth, 1.0]
        assert (clip[2] / clip[3] + 1.0) / 2.0 == pytest.approx(end)
    assert depth_of(np.array([[0.0, 1.0]]), spec).tolist() == [[pytest.approx(0.5), math.inf]]
