"""SIGKILL of what starts a system: every process of the system ends, too."""

import pytest
import waiting
from programs import Program

from aro_robocop_goto_as.process.ports import free_port

RUNS = "robot at x"
EMPTY = ("world:=empty", "drive:=kinematic")
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "command, said, running",
    [
        (("robocop_goto.py", "5", "0", "--world", "empty"), "driving", "robocop_goto_as.py"),
        (
            ("robocop_launch.py", "--screen", "aro_robocop_goto_as", "robocop_goto_as.launch", "rviz:=false", *EMPTY),
            RUNS,
            "robocop_rviz_goto_ac.py",
        ),
        pytest.param(
            ("robocop_launch.py", "--screen", "aro_robocop_goto_as", "robocop_sim.launch", *EMPTY),
            RUNS,
            "_sim.py",
            marks=SLOW,
        ),
    ],
)
def test_every_process_ends_with_what_started_it(tmp_path, command, said, running):
    launch = [f"--port={free_port()}"] if command[0] == "robocop_launch.py" else []
    master = f"http://localhost:{free_port() if not launch else launch[0].partition('=')[2]}"
    started = Program(tmp_path, command[0], *launch, *command[1:], ROS_MASTER_URI=master, DISPLAY="")
    try:
        started.wait_until(lambda: said in started.output, said)
        started.wait_for_process(running)
        started.process.kill()
        started.process.wait()
        waiting.wait_for(lambda: not started.processes(), lambda: f"the end of {started.processes()}: {started.output}")
    finally:
        started.kill()
