"""./robocop that is ended while it sets up its workspace leaves no files behind."""

import os
import signal
import subprocess
from pathlib import Path

import pytest
from waiting import DEADLINE, wait_for

ROOT = Path(__file__).resolve().parents[2]
CATKINS = Path(os.environ["ROBOCOP_STATE"], "tmp")  # for the temporary files of catkin's set-up files


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_ended_while_the_workspace_is_set_up_it_leaves_no_temporary_file(tmp_path, number):
    environment = {**os.environ, "TMPDIR": str(tmp_path), "ROS_HOME": str(tmp_path / "ros")}
    CATKINS.mkdir(exist_ok=True)
    before = CATKINS.stat().st_mtime_ns

    def heed_hangups():  # also below nohup, where a shell cannot
        signal.signal(signal.SIGHUP, signal.SIG_DFL)

    command = [ROOT / "robocop", "shell", "sleep", "600"]
    started = subprocess.Popen(command, env=environment, start_new_session=True, preexec_fn=heed_hangups)
    try:
        # By the folder's time: the file itself is gone so soon that it may be missed.
        wait_for(lambda: CATKINS.stat().st_mtime_ns != before, "a temporary file of catkin", poll=0.001)
        started.send_signal(number)
        assert started.wait(DEADLINE) == -number
        assert list(tmp_path.iterdir()) == []
    finally:
        started.kill()


def test_a_start_removes_what_earlier_ones_that_were_killed_have_left():
    left = CATKINS / "setup.sh.left"
    CATKINS.mkdir(exist_ok=True)
    left.touch()
    os.utime(left, (0, 0))
    subprocess.run([ROOT / "robocop", "shell", "true"], check=True)
    assert not left.exists()
