"""`robocop grade --watch`: a run is shown in RViz at real time, and closing RViz does not change the grade."""

import time

import pytest
from desktop import Desktop
from waiting import DEADLINE, wait_for
from watched_grading import DURATION, Watched

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("hosting")]  # it uses the workspace that hosting tests build
TITLE, INTERRUPTED = " - RViz$", 130


class WatchedInRviz(Watched):
    """`robocop grade --watch` on a desktop."""

    def view(self):
        """The id of the window of RViz's 3D view, looked for anew each time: an RViz that crashes is restarted."""
        window = self.desktop.window(TITLE)
        return window and self.desktop.canvas(window)

    def wait_for_picture(self, parts, what):
        """Wait until RViz has shown each of these parts of the scenario."""
        missing = set(parts)

        def drawn():
            view = self.view()
            if view:
                missing.difference_update(shown(self.desktop.pixels(view)))
            return not missing

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
    with Desktop(tmp_path) as desktop, WatchedInRviz(tmp_path, desktop) as grading:
        grading.wait_for(grading.view, "RViz's view")
        started = time.monotonic()
        everything = {"scan", "goal", "text", "wall", "way", "robot"}
        grading.wait_for_picture(everything, "the scenario drawn in RViz")
        grading.wait_for_full_marks()
        least = DURATION / 2  # RViz's window may be seen late on a busy machine; at full speed it takes a tenth
        assert time.monotonic() - started > least, "the run was not shown at real time"
        assert desktop.window(TITLE) is None, "RViz outlived the grading"


def test_grading_continues_when_rviz_is_closed(tmp_path):
    with Desktop(tmp_path) as desktop, WatchedInRviz(tmp_path, desktop, ahead=5.0) as grading:
        grading.wait_for_picture({"goal"}, "the goal drawn in RViz")
        desktop.quit_by_menu(desktop.window(TITLE))
        wait_for(lambda: desktop.window(TITLE) is None, "RViz closed")
        assert grading.process.poll() is None, "it was the grading's end that closed RViz"
        grading.wait_for_full_marks()


def test_rviz_ends_with_a_grading_that_is_interrupted(tmp_path):
    with Desktop(tmp_path) as desktop, WatchedInRviz(tmp_path, desktop) as grading:
        grading.wait_for(grading.view, "RViz's view")
        grading.process.interrupt()
        assert grading.process.wait(DEADLINE) == INTERRUPTED, grading.process.output
        wait_for(lambda: desktop.window(TITLE) is None, "RViz ended")
