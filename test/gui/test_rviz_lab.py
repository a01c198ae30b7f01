"""The original lab's set-up in RViz: `robocop sim --with` shows what that set-up has."""

import subprocess
from pathlib import Path

import pytest
from desktop import Desktop
from systems import System
from test_rviz_starts import TITLE, shown
from waiting import wait_for

ROOT = Path(__file__).resolve().parents[2]
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("hosting")]  # it uses the workspace that hosting tests build


PARTS = {"robot", "scan"}


def parts_shown(desktop):
    """The parts of the scene in RViz; None before it is open."""
    window = desktop.window(TITLE)
    canvas = window and desktop.canvas(window)
    if not canvas:
        return None
    pixels = desktop.pixels(canvas)
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    scan = (red > 140) & (2 * green < red) & (2 * blue < red)
    return shown(pixels) | ({"scan"} if scan.sum() > 300 else set())


def test_hosted_package_is_shown_as_far_as_the_labs_set_up_allows(tmp_path):
    subprocess.run([ROOT / "robocop", "new", "my_lab"], cwd=tmp_path, check=True)
    with Desktop(tmp_path) as desktop, System(tmp_path, desktop.environment) as ros:
        process = ros.start("sim", ROOT / "robocop", "sim", "--with", tmp_path / "my_lab")
        try:
            wait_for(
                lambda: process.poll() is not None or parts_shown(desktop) == {"robot", "scan"},
                "robot and scan in RViz",
            )
            assert process.poll() is None, process.output
        finally:
            desktop.save_picture()
        assert "nobody publishes the transform odom -> base_footprint" in process.output
