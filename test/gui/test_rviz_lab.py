"""The original lab's set-up in RViz: `robocop sim --with` shows what that set-up has, and no display in red."""

import signal
import subprocess
from pathlib import Path

import pytest
from desktop import Desktop, end
from test_rviz_starts import TITLE, problems, shown
from waiting import wait_for

from aro_robocop_goto_as.process.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("hosting")]  # it uses the workspace that hosting tests build


def parts_shown(desktop):
    """The parts of the scene in RViz; None unless the Displays panel is free of errors and warnings."""
    window = desktop.window(TITLE)
    canvas = window and desktop.canvas(window)
    if not canvas or problems(desktop.pixels(window)[:, : desktop.geometry(canvas)[0]]):
        return None
    pixels = desktop.pixels(canvas)
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    scan = (red > 140) & (2 * green < red) & (2 * blue < red)
    return shown(pixels) | ({"scan"} if scan.sum() > 300 else set())


@pytest.mark.parametrize(
    "arguments, parts, says_what_is_missing",
    [([], {"robot", "scan"}, True), (["odom_tf:=true"], {"robot", "scan", "walls"}, False)],
    ids=["as_the_lab", "with_transform"],
)
def test_hosted_package_is_shown_as_far_as_the_labs_set_up_allows(tmp_path, arguments, parts, says_what_is_missing):
    subprocess.run([ROOT / "robocop", "new", "my_lab"], cwd=tmp_path, check=True)
    output = tmp_path / "output"
    with Desktop(tmp_path) as desktop, open(output, "wb") as log:
        environment = {**desktop.environment, "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
        command = [ROOT / "robocop", "sim", "--with", tmp_path / "my_lab", *arguments]
        environment.update(ROS_HOSTNAME="localhost", ROS_HOME=str(tmp_path / "ros"))
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
        try:
            wait_for(lambda: process.poll() is not None or parts_shown(desktop) == parts, f"{parts} in RViz")
            assert process.poll() is None, output.read_text()
        finally:
            desktop.save_picture()
            end(process, signal.SIGINT)
    assert ("nobody publishes the transform odom -> base_footprint" in output.read_text()) is says_what_is_missing
