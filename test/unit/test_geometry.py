"""Poses on the plane and in space."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.geometry import (
    Pose2D,
    Pose3D,
    compose,
    compose3,
    inverse,
    inverse3,
    lifted,
    quaternion_from_rpy,
    rotation_matrix,
    wrap_angle,
    yaw_of,
)

lengths = st.floats(-1e3, 1e3)
angles = st.floats(-20.0, 20.0)
poses = st.builds(Pose2D, lengths, lengths, angles)
near = st.floats(-9.0, 9.0)
spatial = st.builds(lambda *six: Pose3D.from_xyz_rpy(six[:3], six[3:]), *(6 * [near]))


@given(angles)
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@given(poses)
def test_a_pose_composed_with_its_inverse_is_the_identity(pose):
    there_and_back = compose(pose, inverse(pose))
    assert (there_and_back.x, there_and_back.y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert wrap_angle(there_and_back.yaw) == pytest.approx(0.0, abs=1e-9)


@given(spatial, spatial)
def test_poses_in_space_compose_as_their_matrices_and_the_inverse_undoes_that(a, b):
    both, turn = compose3(a, b), rotation_matrix(a.orientation)
    assert both.position == pytest.approx(turn @ np.array(b.position) + np.array(a.position))
    assert rotation_matrix(both.orientation) == pytest.approx(turn @ rotation_matrix(b.orientation))
    back = compose3(inverse3(a), both)
    assert back.position == pytest.approx(b.position, abs=1e-9)
    assert rotation_matrix(back.orientation) == pytest.approx(rotation_matrix(b.orientation), abs=1e-9)


@given(poses, poses)
def test_composing_on_the_plane_and_in_space_agree(a, b):
    flat, spatial = compose(a, b), compose3(lifted(a), lifted(b, 0.2))
    assert spatial.position == pytest.approx((flat.x, flat.y, 0.2), abs=1e-6)
    assert wrap_angle(yaw_of(spatial.orientation) - flat.yaw) == pytest.approx(0.0, abs=1e-6)


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3))
def test_roll_pitch_yaw_turn_about_the_fixed_axes_in_that_order(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    assert rotation_matrix(quaternion_from_rpy(roll, pitch, yaw)) == pytest.approx(about_z @ about_y @ about_x)
