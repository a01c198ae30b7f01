"""`robocop grade --watch`: a run is shown in RViz at real time, and closing RViz does not change the grade."""

import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from desktop import Desktop, end
from processes import busy_processes
from waiting import DEADLINE, wait_for

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.xdist_group("hosting")  # it uses the workspace that hosting tests build
AHEAD = 1.0  # [m] of the goal
DURATION = 4.5  # [s, simulated] until it is reached: this server drives at 0.2 m/s and stops 0.1 m before
SPARE = 0.5  # [s] less wall time than the run takes at real time: waiting for real time does not count
PLAN = """
limits: {wall_time: WALL}
scenarios:
  - name: beside_a_wall
    about: A goal ahead, a wall beside the way
    obstacles:
      - {box: [0.8, 0.7, 0.0, 1.2, 0.1]}
    script:
      - {goal: [AHEAD, 0.0], ends: SUCCEEDED}
checks:
  action_server: {part: server, points: 0.5, scenarios: [start]}
  reaches_goal: {part: server, points: 0.4, scenarios: [beside_a_wall]}
  stays_alive: {part: server, points: 0.1, scenarios: [start, beside_a_wall]}
"""
TITLE, INTERRUPTED = " - RViz$", 130


class Watched:
    """`robocop grade --watch` of the base solution, on a desktop."""

    def __init__(self, folder, desktop, ahead=AHEAD):
        self.folder = folder
        self.desktop = desktop
        submission = folder / "robocop_goto_as.py"
        shutil.copy(ROOT / "test" / "solutions" / "base_server.py.in", submission)
        wall_time = DURATION - SPARE + (ahead - AHEAD) / 0.2
        (folder / "plan.yaml").write_text(PLAN.replace("AHEAD", str(ahead)).replace("WALL", str(wall_time)))
        self.out, self.errors = folder / "grade.log", folder / "grade.err"
        with open(self.out, "wb") as log, open(self.errors, "wb") as errors:
            self.process = subprocess.Popen(
                [
                    ROOT / "robocop",
                    "grade",
                    submission,
                    "--watch",
                    "--plan",
                    folder / "plan.yaml",
                    "--report",
                    folder / "report",
                ],
                env=desktop.environment,
                stdout=log,
                stderr=errors,
            )

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        try:
            if failure:
                self.desktop.save_picture()
        finally:
            end(self.process, signal.SIGINT)

    def wait_for(self, condition, what):
        """The first true value of a condition, while the grading runs."""

        def look():
            ended = self.process.poll() is not None
            value = condition()
            assert value or not ended, f"the grading ended without {what}: {self.text()}"
            return value

        return wait_for(look, what)

    def wait_for_full_marks(self):
        assert self.process.wait(DEADLINE) == 0, self.text()
        assert "1 of 1 points" in self.text()

    def text(self):
        return self.out.read_text() + self.errors.read_text()

    def view(self):
        """The id of the window of RViz's 3D view, looked for anew each time: an RViz that crashes is restarted."""
        window = self.desktop.window(TITLE)
        return window and self.desktop.canvas(window)

    def wait_for_picture(self, parts, what):
        """Wait until RViz shows these parts of the scenario."""

        def drawn():
            view = self.view()
            return view and shown(self.desktop.pixels(view)) >= parts

        self.wait_for(drawn, what)


def shown(pixels):
    """The parts of a scenario that RViz shows, recognised by their colours."""
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    least = {
        "scan": (200, (red > 140) & (2 * green < red) & (2 * blue < red)),
        "goal": (100, (red > 140) & (2 * green < red) & (2 * blue > red)),
        "text": (200, (red > 200) & (green > 200) & (blue > 200)),
        "wall": (3000, (red > 55) & (red < 120) & (blue > red + 8) & (blue < red + 30) & (green > red)),
        "way": (50, (blue > 200) & (green > 140) & (red < 140)),
        "robot": (30, (blue > 90) & (2 * red < blue) & (1.5 * green < blue)),  # the lidar on top of it
    }
    return {what for what, (count, where) in least.items() if where.sum() > count}


def test_watched_run_is_shown_in_real_time_and_gets_full_marks(tmp_path):
    with Desktop(tmp_path) as desktop, Watched(tmp_path, desktop) as grading:
        grading.wait_for_picture({"goal"}, "the goal drawn in RViz")
        started = time.monotonic()
        everything = {"scan", "goal", "text", "wall", "way", "robot"}
        grading.wait_for_picture(everything, "the scenario drawn in RViz")
        grading.wait_for_full_marks()
        assert time.monotonic() - started > DURATION - 1.0, "RViz may draw the goal late, but not by a second"
        assert desktop.window(TITLE) is None, "RViz outlived the grading"


@pytest.mark.slow
def test_grading_continues_when_rviz_is_closed(tmp_path):
    with Desktop(tmp_path) as desktop, Watched(tmp_path, desktop, ahead=5.0) as grading:
        grading.wait_for_picture({"goal"}, "the goal drawn in RViz")
        desktop.quit_by_menu(desktop.window(TITLE))
        wait_for(lambda: desktop.window(TITLE) is None, "RViz closed")
        assert grading.process.poll() is None, "it was the grading's end that closed RViz"
        grading.wait_for_full_marks()


@pytest.mark.slow
def test_rviz_ends_with_a_grading_that_is_interrupted(tmp_path):
    with Desktop(tmp_path) as desktop, Watched(tmp_path, desktop) as grading:
        grading.wait_for(grading.view, "RViz's view")
        with busy_processes():
            grading.process.send_signal(signal.SIGINT)
            assert grading.process.wait(DEADLINE) == INTERRUPTED, grading.text()
        wait_for(lambda: desktop.window(TITLE) is None, "RViz ended")
