"""`robocop grade --watch` of a right server that reaches a goal beside a wall."""

from pathlib import Path

from systems import System
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


class Watched(System):
    """`robocop grade --watch` of the base solution, on a desktop or without one; `change` alters its source."""

    def __init__(self, folder, desktop, ahead=AHEAD, change=lambda source: source):
        super().__init__(folder, desktop.environment)
        self.desktop = desktop
        submission, plan = folder / "robocop_goto_as.py", folder / "plan.yaml"
        submission.write_text(change((ROOT / "test" / "solutions" / "base_server.py.in").read_text()))
        submission.chmod(0o755)
        plan.write_text(PLAN.replace("AHEAD", str(ahead)))
        options = ("--watch", "--plan", plan, "--report", folder / "report")
        self.process = self.start("grade", ROOT / "robocop", "grade", submission, *options)

    def __exit__(self, failure, *_):
        try:
            if failure:
                self.desktop.save_picture()
        finally:
            self.end_all()

    def wait_for(self, condition, what):
        """The first true value of a condition, while the grading runs."""

        def look():
            ended = self.process.poll() is not None
            value = condition()
            assert value or not ended, f"the grading ended without {what}: {self.process.output}"
            return value

        return wait_for(look, what)

    def wait_for_full_marks(self):
        assert self.process.wait(DEADLINE) == 0, self.process.output
        assert "1 of 1 points" in self.process.output
