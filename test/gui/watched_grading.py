"""`robocop grade --watch` of a right server that reaches a goal beside a wall."""

import signal
import subprocess
from pathlib import Path

from desktop import end
from waiting import DEADLINE, wait_for

ROOT = Path(__file__).resolve().parents[2]
AHEAD = 1.0  # [m] of the goal
DURATION = (AHEAD - 0.1) / 0.2  # [s, simulated] until it is reached: this server drives at 0.2 m/s, stops 0.1 m before
PLAN = """
limits:
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


class Watched:
    """`robocop grade --watch` of the base solution, on a desktop or without one; `change` alters its source."""

    def __init__(self, folder, desktop, ahead=AHEAD, change=lambda source: source):
        self.folder = folder
        self.desktop = desktop
        submission = folder / "robocop_goto_as.py"
        submission.write_text(change((ROOT / "test" / "solutions" / "base_server.py.in").read_text()))
        submission.chmod(0o755)
        (folder / "plan.yaml").write_text(PLAN.replace("AHEAD", str(ahead)))
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
