"""The programs that show a watched grading, started without ROS."""

import os
from pathlib import Path

import pytest
from waiting import wait_for

from robocop_grading.session import display
from robocop_grading.viewer import Viewer

NODE = """#!/bin/sh
exec tail -f /dev/null
"""


def test_page_that_takes_too_much_memory_is_ended_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rosrun = tmp_path / "rosrun"
    rosrun.write_text(NODE)
    rosrun.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    monkeypatch.setattr(display, "PAGE_MEMORY", 1)
    reader, writer = os.pipe()
    shown = display.Display(Viewer(reader, 1, "http://localhost:1"), "", tmp_path / "viewer.log")
    try:
        shown.start()
        wait_for(lambda: shown.end, "end of the page")
        assert shown.end.startswith("the web page ended (status -9)")
        assert [process.poll() for process in shown._processes[:-1]] == [None]  # robot_state_publisher
    finally:
        shown.close()
        os.close(reader)
        os.close(writer)
