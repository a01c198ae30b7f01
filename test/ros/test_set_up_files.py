"""What ./robocop leaves behind where it is killed while it sets up its workspace is removed by the next start."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CATKINS = Path(os.environ["ROBOCOP_STATE"], "tmp")  # for the temporary files of catkin's set-up files


def test_a_start_removes_what_earlier_ones_that_were_killed_have_left():
    left = CATKINS / "setup.sh.left"
    CATKINS.mkdir(exist_ok=True)
    left.touch()
    os.utime(left, (0, 0))
    subprocess.run([ROOT / "robocop", "shell", "true"], check=True)
    assert not left.exists()
